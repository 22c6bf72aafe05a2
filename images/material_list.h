// The materials of a mesh, and the sources of their pictures.
#pragma once

#include "hierarchy/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::images {

/// A picture that a mesh file names or holds.
struct ImageSource {
  std::string name;               ///< as the mesh names it, for messages
  std::filesystem::path file;     ///< the file it lies in; empty if `data` holds it
  std::uint64_t offset = 0;       ///< its first byte in that file
  std::uint64_t bytes = 0;        ///< 0: to the end of the file
  std::vector<std::byte> data{};  ///< the encoded picture, decoded from a data URI
  bool is_packed = false;         ///< the file is in gzip or OSGB: they count in its content
  bool is_drape = false;          ///< a TIFF on a map, with a frame (tiff_picture.h)
  friend bool operator==(const ImageSource&, const ImageSource&) = default;
};

struct Material {
  std::string name;
  std::array<float, 4> colour{1, 1, 1, 1};  ///< sRGB and alpha, 0 ... 1; if it has no picture
  std::optional<std::uint32_t> image;       ///< in MaterialList::images
  /// The factors of the light and the alpha of its picture, from 0 on.
  std::array<float, 4> factor{1, 1, 1, 1};
  /// The light that is added to its picture's then, from 0 on.
  std::array<float, 3> light{0, 0, 0};
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  AlphaMode alpha = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool is_alpha_unsaid = false;  ///< its file does not say whether the alpha of its picture counts
  friend bool operator==(const Material&, const Material&) = default;
};

/// The materials of a mesh. Corners of its triangles name a material by its number; readers refuse
/// a number beyond the last one.
struct MaterialList {
  std::vector<ImageSource> images;
  std::vector<Material> materials;
  bool empty() const { return materials.empty(); }
  friend bool operator==(const MaterialList&, const MaterialList&) = default;
};

}  // namespace meshhier::images
