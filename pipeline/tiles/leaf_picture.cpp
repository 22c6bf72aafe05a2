#include "pipeline/tiles/leaf_picture.h"

#include "base/srgb.h"
#include "texture/fill.h"
#include "texture/shown_texels.h"
#include "texture/texel_bits.h"
#include "texture/texel_raster.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace meshhier::pipeline {
namespace {

using images::Image;
using texture::AtlasPiece;
using texture::kLeafAlignment;

/// Bands that fit in a cache are still there when they are encoded.
constexpr std::uint32_t kBandTexels = std::uint32_t{1} << 17;

/// Returns the rows of a band: as many rows of blocks as it may have, at least one.
std::uint32_t band_rows(std::uint32_t width) {
  return std::max(kBandTexels / width / kLeafAlignment, 1U) * kLeafAlignment;
}

/// Returns the colour of a material without a picture. Its alpha suits the tile's picture, whose
/// cutoff is 0.5.
std::array<float, 4> shown_colour(const images::Material& material) {
  std::array<float, 4> colour = material.colour;
  if (material.alpha == AlphaMode::opaque)
    colour[3] = 1;
  else if (material.alpha == AlphaMode::mask)
    colour[3] = colour[3] >= material.alpha_cutoff ? 1.0F : 0.0F;
  return colour;
}

void fill(const images::Material& material, Image& image, std::uint32_t left, std::uint32_t top,
          std::uint32_t width, std::uint32_t height) {
  const std::array<float, 4> colour = shown_colour(material);
  for (std::uint32_t y = top; y < top + height; ++y) {
    for (std::uint32_t x = left; x < left + width; ++x) {
      for (std::uint32_t c = 0; c < image.channels; ++c)
        image.at(x, y)[c] = screen_byte(colour[c]);
    }
  }
}

/// Returns for each block whether it belongs to a piece.
std::vector<std::uint8_t> blocks_of(const texture::LeafAtlas& atlas) {
  const std::size_t width = atlas.width / kLeafAlignment;
  std::vector<std::uint8_t> is_piece(width * (atlas.height / kLeafAlignment));
  for (const AtlasPiece& piece : atlas.pieces) {
    for (std::uint32_t y = 0; y < piece.height; y += kLeafAlignment) {
      const std::size_t begin =
          (piece.atlas_y + y) / kLeafAlignment * width + piece.atlas_x / kLeafAlignment;
      std::fill_n(is_piece.begin() + static_cast<std::ptrdiff_t>(begin),
                  piece.width / kLeafAlignment, std::uint8_t{1});
    }
  }
  return is_piece;
}

texture::TexelBits blocks_outside(std::span<const std::uint8_t> is_piece, std::uint32_t width,
                                  std::uint32_t height) {
  texture::TexelBits outside(width, height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      if (is_piece[std::size_t{y} * width + x] == 0)
        outside.set(x, y);
    }
  }
  return outside;
}

void fill_block(const std::uint8_t* texel, Image& image, std::uint32_t left, std::uint32_t top) {
  for (std::uint32_t y = top; y < top + kLeafAlignment; ++y) {
    for (std::uint32_t x = left; x < left + kLeafAlignment; ++x)
      images::copy_texel(texel, image.at(x, y), image.channels);
  }
}

}  // namespace

LeafPicture::LeafPicture(const texture::LeafAtlas& atlas,
                         std::span<const texture::CornerTexcoords> corners,
                         const TexturedInput& input)
    : atlas_(atlas), input_(input), texels_(input.materials.materials.size()) {
  read_materials();
  background_ = Image(atlas.width / kLeafAlignment, atlas.height / kLeafAlignment,
                      alpha_ == AlphaMode::opaque ? 3 : 4);
  find_shown(corners);
  paint_background();
}

void LeafPicture::read_materials() {
  for (const AtlasPiece& piece : atlas_.pieces) {
    const images::Material& material = material_of(piece);
    alpha_ = std::max(alpha_, material.alpha);
    if (material.image && !texels_[piece.material])
      texels_[piece.material].emplace(material, input_.pictures);
  }
}

void LeafPicture::find_shown(std::span<const texture::CornerTexcoords> corners) {
  // A block that the gutter reaches has its middle no farther than a block from the triangle.
  static_assert(2 * texture::kLeafGutter <= kLeafAlignment);
  const std::uint32_t width = background_.width, height = background_.height;
  const texture::TexelRange all{0, 0, width, height};
  const std::vector<std::uint8_t> is_piece = blocks_of(atlas_);
  is_shown_.resize(is_piece.size());
  texture::TexelBits is_settled = blocks_outside(is_piece, width, height);
  const auto is_open = [&](std::uint32_t x, std::uint32_t y) { return !is_settled(x, y); };
  const auto show = [&](std::uint32_t x, std::uint32_t y, const auto&...) {
    const std::size_t block = std::size_t{y} * width + x;
    is_shown_[block] = is_piece[block];
    is_settled.set(x, y);
  };
  for (const texture::CornerTexcoords& triangle : corners) {
    const std::array<texture::TexelPoint, 3> at = texture::in_texels(triangle, width, height);
    if (is_settled.is_full(texture::near_texels(at, all)))
      continue;
    texture::RasterTriangle(at).for_each(width, height, show);
    for (std::size_t k = 0; k < 3; ++k)
      texture::TexelSegment(at[k], at[(k + 1) % 3]).for_each_near(all, is_open, show);
  }
}

/// Paints a picture of an eighth of the size, a texel for each block: pieces from a level of the
/// pictures' pyramids, then all around them.
void LeafPicture::paint_background() {
  constexpr std::uint32_t kUp = std::countr_zero(kLeafAlignment);
  for (const AtlasPiece& piece : atlas_.pieces) {
    const images::Material& material = material_of(piece);
    const std::uint32_t left = piece.atlas_x / kLeafAlignment, width = piece.width / kLeafAlignment;
    const std::uint32_t top = piece.atlas_y / kLeafAlignment,
                        height = piece.height / kLeafAlignment;
    if (material.image) {
      const std::uint32_t last = input_.pictures.levels(*material.image) - 1;
      const std::uint32_t up = std::min(kUp, last - std::min(piece.level, last));
      texels_[piece.material]->read(piece.level + up, piece.x >> up, piece.y >> up, width, height,
                                    background_, left, top);
    } else {
      fill(material, background_, left, top, width, height);
    }
  }
  texture::fill_unknown(background_, is_shown_);
}

Image LeafPicture::band(std::uint32_t top) const {
  Image band(atlas_.width, std::min(band_rows(atlas_.width), atlas_.height - top), channels());
  for (const AtlasPiece& piece : atlas_.pieces)
    paint(piece, band, top);
  cover_rest(band, top);
  return band;
}

void LeafPicture::paint(const AtlasPiece& piece, Image& band, std::uint32_t top) const {
  const std::uint32_t begin = std::max(piece.atlas_y, top);
  const std::uint32_t end = std::min(piece.atlas_y + piece.height, top + band.height);
  if (begin >= end)
    return;
  if (const auto& texels = texels_[piece.material]; texels)
    texels->read(piece.level, piece.x, piece.y + (begin - piece.atlas_y), piece.width, end - begin,
                 band, piece.atlas_x, begin - top);
  else
    fill(material_of(piece), band, piece.atlas_x, begin - top, piece.width, end - begin);
}

void LeafPicture::cover_rest(Image& band, std::uint32_t top) const {
  for (std::uint32_t y = 0; y < band.height; y += kLeafAlignment) {
    const std::uint32_t row = (top + y) / kLeafAlignment;
    for (std::uint32_t x = 0; x < background_.width; ++x) {
      if (is_shown_[std::size_t{row} * background_.width + x] == 0)
        fill_block(background_.at(x, row), band, x * kLeafAlignment, y);
    }
  }
}

std::uint64_t LeafPicture::bytes(std::uint32_t width, std::uint32_t height) {
  constexpr std::uint64_t kChannels = 4, kFilling = 2 * sizeof(std::uint32_t) + 1;
  const std::uint64_t blocks = std::uint64_t{width} * height / (kLeafAlignment * kLeafAlignment);
  return std::uint64_t{width} * std::min(band_rows(width), height) * kChannels +
         blocks * (kChannels + kFilling);
}

}  // namespace meshhier::pipeline
