// Materials of a glTF file as those of a mesh.
#pragma once

#include "import/material_colours.h"
#include "import/material_table.h"
#include "mesh_io/gltf_file.h"

#include <cstdint>
#include <map>
#include <optional>

namespace meshhier::importing {

class GltfMaterials {
 public:
  explicit GltfMaterials(mesh_io::GltfFile& file) : file_(file) {}

  /// Says that triangles use a material (none: the default one); `has_texcoords`: with the
  /// coordinates that its texture takes. Looks where the picture is.
  void use(std::optional<std::uint32_t> material, bool has_texcoords);

  /// Whether a picture is there for any triangle.
  bool is_textured() const { return is_textured_; }
  /// Whether a picture of any is in KTX2 alone.
  bool shows_ktx2() const { return shows_ktx2_; }
  /// The base colours of all, without pictures.
  const PlainColours& colours() const { return colours_; }
  PlainColour colour(std::optional<std::uint32_t> material) const;

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
  Use look_up(const mesh_io::GltfMaterial& material);
  images::Material material(std::int64_t key, Use& use, MaterialTable& table) const;

  mesh_io::GltfFile& file_;
  std::map<std::int64_t, Use> uses_;
  bool is_textured_ = false;
  bool shows_ktx2_ = false;
  PlainColours colours_;
};

}  // namespace meshhier::importing
