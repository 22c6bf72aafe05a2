// Materials of a glTF file as those of a mesh.
#pragma once

#include "import/material_colours.h"
#include "import/material_table.h"
#include "mesh_io/gltf_file.h"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace meshhier::importing {

/// The part of a material that is shown: the light `texture * factor + light`, or `factor + light`
/// without a texture. A tile shows one picture, which colours of vertices multiply as a whole.
struct GltfLook {
  const mesh_io::GltfTextureUse* texture = nullptr;
  std::array<double, 4> factor{1, 1, 1, 1};
  std::array<double, 3> light{};
  bool is_untinted = false;    ///< colours of vertices have no part in it: its base colour is black
  bool drops_light = false;    ///< the emission is not shown, whatever the mesh is like
  bool has_own_light = false;  ///< `light` is not 0, and colours of vertices must not multiply it
};

/// Returns the light that a material adds to the colours of vertices times its factor, where no
/// picture is shown.
std::array<double, 3> plain_light(const mesh_io::GltfMaterial& material);

/// Returns what a material shows. `is_coloured`: a primitive with the material has colours of
/// vertices.
GltfLook look_of(const mesh_io::GltfMaterial& material, bool is_coloured);

/// The materials of a file that triangles use: first use() for all, then the questions, then
/// add_to().
class GltfMaterials {
 public:
  explicit GltfMaterials(mesh_io::GltfFile& file);

  /// Says that triangles use a material (none: the default one); `has_texcoords`: they have the
  /// coordinates that its texture takes. Looks for the picture.
  void use(std::optional<std::uint32_t> material, bool has_texcoords);
  /// Returns what a material shows; the default one is white.
  const GltfLook& look(std::optional<std::uint32_t> material) const;
  /// Returns the name of the coordinates that a material's texture takes.
  std::string texcoords(std::optional<std::uint32_t> material) const;

  /// Returns whether a picture is there for any triangle.
  bool is_textured() const { return is_textured_; }
  /// Returns the formats that are not read and in which alone a used texture has its picture.
  const std::set<const mesh_io::GltfPictureFormat*>& unread_formats() const { return unread_; }
  /// Returns the colours of all materials that are used, without pictures.
  const PlainColours& colours() const { return colours_; }
  PlainColour colour(std::optional<std::uint32_t> material) const;
  /// Returns whether any material adds light of its own.
  bool emit() const { return emit_; }
  /// Returns how many have a colour that light shines through.
  std::uint64_t translucent() const;
  /// Returns how many have pictures of which none is known to be their colour.
  std::uint64_t unknown() const;
  /// Returns how many have an emission that is not shown as a whole.
  std::uint64_t dropped_lights(bool is_textured) const;

  /// Tells `table` which pictures are not there.
  void tell_missing(MaterialTable& table) const;
  /// Moves the materials that are used to `table`, in the order of the document; the last step.
  void add_to(MaterialTable& table);
  /// Returns a material's number in the table that add_to() filled.
  std::uint32_t number(std::optional<std::uint32_t> material) const;

 private:
  static constexpr std::int64_t kDefault = -1;  ///< comes before all others

  struct Use {
    std::optional<mesh_io::GltfPicture> picture;  ///< its texture's, if it has one
    bool has_picture() const { return picture && picture->is_there(); }
    std::uint32_t number = 0;
  };

  static std::int64_t key(std::optional<std::uint32_t> material) {
    return material ? std::int64_t{*material} : kDefault;
  }
  template <class Judge>
  std::uint64_t count(const Judge& judge) const;
  Use look_up(const GltfLook& look);
  images::Material material(std::int64_t key, Use& use, MaterialTable& table) const;

  mesh_io::GltfFile& file_;
  std::vector<GltfLook> looks_;  ///< looks of the document's materials
  std::map<std::int64_t, Use> uses_;
  bool is_textured_ = false;
  std::set<const mesh_io::GltfPictureFormat*> unread_;
  bool emit_ = false;
  PlainColours colours_;
};

}  // namespace meshhier::importing
