// The picture of a partition, painted from the input's pictures by bands of rows.
#pragma once

#include "hierarchy/texture.h"
#include "images/image.h"
#include "images/image_store.h"
#include "images/material_list.h"
#include "images/material_texels.h"
#include "texture/leaf_atlas.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::pipeline {

/// Materials, and the pictures that they number.
struct TexturedInput {
  const images::MaterialList& materials;
  const images::ImageStore& pictures;
};

/// Blocks of kLeafAlignment * kLeafAlignment texels that triangles and their gutters reach are the
/// input's. All others, between pieces or in them, have about the colour of the nearest of those:
/// smaller pictures that viewers make of it have no black in them, and encoders nothing to do.
/// Thread-safe once constructed. Reading pictures throws Error(io | corrupt).
class LeafPicture {
 public:
  /// `atlas`, which has a piece or more, and `input` must outlive it. `corners`: those of all
  /// triangles, in the atlas.
  LeafPicture(const texture::LeafAtlas& atlas, std::span<const texture::CornerTexcoords> corners,
              const TexturedInput& input);

  /// The strongest alpha among the materials that are shown.
  AlphaMode alpha() const { return alpha_; }
  std::uint32_t channels() const { return background_.channels; }
  /// Returns rows from `top` on, a multiple of kLeafAlignment of them: about 130,000 texels.
  images::Image band(std::uint32_t top) const;

  /// Returns the memory that it holds, a band included.
  static std::uint64_t bytes(std::uint32_t width, std::uint32_t height);

 private:
  const images::Material& material_of(const texture::AtlasPiece& piece) const {
    return input_.materials.materials[piece.material];
  }
  void read_materials();
  void find_shown(std::span<const texture::CornerTexcoords> corners);
  void paint_background();
  void paint(const texture::AtlasPiece& piece, images::Image& band, std::uint32_t top) const;
  void cover_rest(images::Image& band, std::uint32_t top) const;

  const texture::LeafAtlas& atlas_;
  const TexturedInput& input_;
  AlphaMode alpha_ = AlphaMode::opaque;
  std::vector<std::optional<images::MaterialTexels>> texels_;  ///< for materials with pictures
  images::Image background_;                                   ///< a texel for each block
  std::vector<std::uint8_t> is_shown_;  ///< per block: a triangle or its gutter reaches it
};

}  // namespace meshhier::pipeline
