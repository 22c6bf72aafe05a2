#include "images/material_texels.h"

#include "images/srgb.h"

#include <cmath>
#include <cstddef>

namespace meshhier::images {
namespace {

constexpr std::size_t kAlpha = 3;

/// A colour's value is one of light, alpha's is not.
std::uint8_t times(float factor, std::size_t value, std::size_t channel) {
  if (channel == kAlpha)
    return static_cast<std::uint8_t>(std::lround(factor * static_cast<double>(value)));
  return screen_value(factor * light_of(static_cast<double>(value) / 255));
}

}  // namespace

MaterialTexels::MaterialTexels(const Material& material, const ImageStore& pictures)
    : pictures_(pictures),
      image_(material.image.value()),
      wrap_u_(material.wrap_u),
      wrap_v_(material.wrap_v),
      is_tinted_(material.factor != Material{}.factor) {
  if (!is_tinted_)
    return;
  for (std::size_t c = 0; c < tinted_.size(); ++c) {
    for (std::size_t value = 0; value < tinted_[c].size(); ++value)
      tinted_[c][value] = times(material.factor[c], value, c);
  }
}

void MaterialTexels::read(std::uint32_t level, std::int64_t x, std::int64_t y, std::uint32_t width,
                          std::uint32_t height, Image& into, std::uint32_t at_x,
                          std::uint32_t at_y) const {
  pictures_.read({image_, level, x, y, width, height, wrap_u_, wrap_v_}, into, at_x, at_y);
  if (!is_tinted_)
    return;
  for (std::uint32_t row = 0; row < height; ++row) {
    for (std::uint32_t column = 0; column < width; ++column)
      tint(into.at(at_x + column, at_y + row), into.channels);
  }
}

}  // namespace meshhier::images
