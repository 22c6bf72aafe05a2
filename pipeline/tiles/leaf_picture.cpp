#include "pipeline/tiles/leaf_picture.h"

#include "texture/fill.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

namespace meshhier::pipeline {
namespace {

using images::Image;
using texture::AtlasPiece;
using texture::kLeafAlignment;

constexpr std::uint32_t kBandTexels = std::uint32_t{1} << 20;

/// Of rows of blocks, as large a number as a band may have; at least one.
std::uint32_t band_rows(std::uint32_t width) {
  return std::max(kBandTexels / width / kLeafAlignment, 1U) * kLeafAlignment;
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

void fill(const std::array<float, 4>& colour, Image& image, std::uint32_t left, std::uint32_t top,
          std::uint32_t width, std::uint32_t height) {
  for (std::uint32_t y = top; y < top + height; ++y) {
    for (std::uint32_t x = left; x < left + width; ++x) {
      for (std::uint32_t c = 0; c < image.channels; ++c)
        image.at(x, y)[c] = to_byte(colour[c]);
    }
  }
}

}  // namespace

LeafPicture::LeafPicture(const texture::LeafAtlas& atlas, const TexturedInput& input)
    : atlas_(atlas), input_(input), texels_(input.materials.materials.size()) {
  read_materials();
  background_ = Image(atlas.width / kLeafAlignment, atlas.height / kLeafAlignment,
                      alpha_ == AlphaMode::opaque ? 3 : 4);
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

/// Of an eighth of the size, from a level of the pictures' pyramids; then between pieces.
void LeafPicture::paint_background() {
  constexpr std::uint32_t kUp = std::countr_zero(kLeafAlignment);
  std::vector<std::uint8_t> is_known(std::size_t{background_.width} * background_.height);
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
      fill(material.colour, background_, left, top, width, height);
    }
    for (std::uint32_t y = top; y < top + height; ++y)
      std::fill_n(is_known.begin() + std::ptrdiff_t(std::size_t{y} * background_.width + left),
                  width, std::uint8_t{1});
  }
  texture::fill_unknown(background_, is_known);
}

Image LeafPicture::band(std::uint32_t top) const {
  Image band(atlas_.width, std::min(band_rows(atlas_.width), atlas_.height - top), channels());
  paint_block_rows(band, top);
  for (const AtlasPiece& piece : atlas_.pieces)
    paint(piece, band, top);
  return band;
}

void LeafPicture::paint_block_rows(Image& band, std::uint32_t top) const {
  const std::size_t row_bytes = std::size_t{band.width} * band.channels;
  for (std::uint32_t y = 0; y < band.height; ++y) {
    if (y % kLeafAlignment > 0) {
      std::copy_n(band.at(0, y - 1), row_bytes, band.at(0, y));
      continue;
    }
    for (std::uint32_t x = 0; x < band.width; ++x)
      std::copy_n(background_.at(x / kLeafAlignment, (top + y) / kLeafAlignment), band.channels,
                  band.at(x, y));
  }
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
    fill(material_of(piece).colour, band, piece.atlas_x, begin - top, piece.width, end - begin);
}

std::uint64_t LeafPicture::bytes(std::uint32_t width, std::uint32_t height) {
  constexpr std::uint64_t kChannels = 4, kFilling = 2 * sizeof(std::uint32_t) + 1;
  const std::uint64_t blocks = std::uint64_t{width} * height / (kLeafAlignment * kLeafAlignment);
  return std::uint64_t{width} * std::min(band_rows(width), height) * kChannels +
         blocks * (kChannels + kFilling);
}

}  // namespace meshhier::pipeline
