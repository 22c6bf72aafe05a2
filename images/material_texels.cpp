#include "images/material_texels.h"

#include "base/srgb.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace meshhier::images {
namespace {

constexpr std::size_t kAlpha = 3;
constexpr double kMost = 255;

std::uint8_t shown_alpha(const Material& material, std::size_t value) {
  constexpr double kCutoff = 0.5;  // the cutoff of the pictures that are written
  double alpha = material.factor[kAlpha] * static_cast<double>(value) / kMost;
  if (material.alpha == AlphaMode::opaque)
    alpha = 1;
  else if (material.alpha == AlphaMode::mask)
    alpha = material.alpha_cutoff > 0 ? alpha * kCutoff / material.alpha_cutoff : 1;
  return static_cast<std::uint8_t>(std::lround(std::min(alpha, 1.0) * kMost));
}

/// A colour's value is one of light, alpha's is not.
std::uint8_t shown_value(const Material& material, std::size_t channel, std::size_t value) {
  if (channel == kAlpha)
    return shown_alpha(material, value);
  if (material.factor[channel] == 1 && material.light[channel] == 0)
    return static_cast<std::uint8_t>(value);
  return screen_value(material.factor[channel] * light_of(static_cast<double>(value) / kMost) +
                      material.light[channel]);
}

}  // namespace

MaterialTexels::MaterialTexels(const Material& material, const ImageStore& pictures)
    : pictures_(pictures),
      image_(material.image.value()),
      wrap_u_(material.wrap_u),
      wrap_v_(material.wrap_v) {
  for (std::size_t c = 0; c < tinted_.size(); ++c) {
    for (std::size_t value = 0; value < tinted_[c].size(); ++value) {
      tinted_[c][value] = shown_value(material, c, value);
      if (tinted_[c][value] != value)
        tinted_channels_ |= 1U << c;
    }
  }
}

void MaterialTexels::read(std::uint32_t level, std::int64_t x, std::int64_t y, std::uint32_t width,
                          std::uint32_t height, Image& into, std::uint32_t at_x,
                          std::uint32_t at_y) const {
  pictures_.read({image_, level, x, y, width, height, wrap_u_, wrap_v_}, into, at_x, at_y);
  tint(into, at_x, at_y, width, height);
}

void MaterialTexels::tint(Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t width,
                          std::uint32_t height) const {
  for (std::uint32_t c = 0; c < image.channels; ++c) {
    if ((tinted_channels_ >> c & 1) == 0)
      continue;
    for (std::uint32_t row = y; row < y + height; ++row) {
      std::uint8_t* values = image.at(x, row) + c;
      for (std::uint32_t i = 0; i < width; ++i)
        values[i * image.channels] = tinted_[c][values[i * image.channels]];
    }
  }
}

}  // namespace meshhier::images
