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
#include <vector>

namespace meshhier::importing {

/// What of a material is shown: the light `texture * factor + light`, or `factor + light` without a
/// texture. A tile shows one picture, which colours of vertices multiply as a whole.
struct GltfLook {
  const mesh_io::GltfTextureUse* texture = nullptr;
  std::array<double, 4> factor{1, 1, 1, 1};
  std::array<double, 3> light{};
  bool is_untinted = false;    ///< colours of vertices have no part in it: its base colour is black
  bool drops_light = false;    ///< the emission is not shown, whatever the mesh is like
  bool has_own_light = false;  ///< `light` is not 0, and colours of vertices must not multiply it
};

/// What it adds to the colours of vertices times its factor, where no picture is shown.
std::array<double, 3> plain_light(const mesh_io::GltfMaterial& material);

/// `is_coloured`: a primitive with the material has colours of vertices.
GltfLook look_of(const mesh_io::GltfMaterial& material, bool is_coloured);

class GltfMaterials {
 public:
  explicit GltfMaterials(mesh_io::GltfFile& file);

  /// Says that triangles use a material (none: the default one); `has_texcoords`: with the
  /// coordinates that its texture takes. Looks where the picture is.
  void use(std::optional<std::uint32_t> material, bool has_texcoords);
  /// What all materials show: of the default one white.
  const GltfLook& look(std::optional<std::uint32_t> material) const;

  /// Whether a picture is there for any triangle.
  bool is_textured() const { return is_textured_; }
  /// Those of which a picture of any is there alone.
  const std::set<const mesh_io::GltfPictureFormat*>& unread_formats() const { return unread_; }
  /// The colours of all, without pictures.
  const PlainColours& colours() const { return colours_; }
  PlainColour colour(std::optional<std::uint32_t> material) const;
  /// Whether any adds light of its own.
  bool emit() const { return emit_; }
  /// How many have a colour that light shines through.
  std::uint64_t translucent() const;
  /// How many have pictures of which none is known to be their colour.
  std::uint64_t unknown() const;
  /// Of how many a part of the emission is not shown.
  std::uint64_t dropped_lights(bool is_textured) const;

  /// Tells `table` which pictures are not there.
  void tell_missing(MaterialTable& table) const;
  /// Moves the materials that are used to `table`, in the order of the document; the last step.
  void add_to(MaterialTable& table);
  /// In the table that add_to() had.
  std::uint32_t number(std::optional<std::uint32_t> material) const;

 private:
  static constexpr std::int64_t kDefault = -1;  ///< before all others

  struct Use {
    std::optional<mesh_io::GltfPicture> picture;  ///< of its texture, if it has one
    bool has_picture() const { return picture && (picture->file || !picture->data.empty()); }
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
  std::vector<GltfLook> looks_;  ///< of the document's materials
  std::map<std::int64_t, Use> uses_;
  bool is_textured_ = false;
  std::set<const mesh_io::GltfPictureFormat*> unread_;
  bool emit_ = false;
  PlainColours colours_;
};

}  // namespace meshhier::importing
