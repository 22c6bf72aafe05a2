// Texels as light, in single precision, to make means of them.
#pragma once

#include "base/four_floats.h"
#include "texture/texel_raster.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace meshhier::texture {

/// The light, 0 to 1, of each 8-bit value.
extern const std::array<float, 256> kLight;

/// The 8-bit value nearest to a light, which is cut to 0 to 1.
std::uint8_t value_of_light(float light);

/// 0 to 1 in 255 steps: what is stored as it is, such as alpha.
inline std::uint8_t value_of_part(float part) {
  return static_cast<std::uint8_t>(part * 255 + 0.5f);
}

/// Light of red, green and blue times alpha, and alpha.
using TexelLight = std::array<float, 4>;

/// Returns `weight` times a texel of 3 or 4 channels.
inline FourFloats weighted_light(const std::uint8_t* texel, std::uint32_t channels, float weight) {
  static_assert(sizeof(FourFloats) == sizeof(TexelLight));
  if (channels == 4)
    weight *= static_cast<float>(texel[3]) / 255;
  return FourFloats{kLight[texel[0]], kLight[texel[1]], kLight[texel[2]], 1} * weight;
}

inline void add_texel(TexelLight& sum, const std::uint8_t* texel, std::uint32_t channels,
                      float weight) {
  store_four(&sum, load_four(&sum) + weighted_light(texel, channels, weight));
}

/// Stores a mean; what is not there at all is black.
void store_texel(FourFloats mean, std::uint8_t* texel, std::uint32_t channels);
inline void store_texel(const TexelLight& mean, std::uint8_t* texel, std::uint32_t channels) {
  store_texel(load_four(&mean), texel, channels);
}

inline TexelPoint middle_of(const std::array<TexelPoint, 3>& corners) {
  return {(corners[0].x + corners[1].x + corners[2].x) / 3,
          (corners[0].y + corners[1].y + corners[2].y) / 3};
}

/// The number of the texel at a point, or of the nearest one in the picture.
inline std::size_t texel_at(const TexelPoint& at, std::uint32_t width, std::uint32_t height) {
  const auto inside = [](double place, std::uint32_t side) {
    return place > 0 ? static_cast<std::size_t>(std::min(place, side - 1.0)) : 0;
  };
  return inside(at.y, height) * width + inside(at.x, width);
}

}  // namespace meshhier::texture
