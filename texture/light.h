// Light of texels, in single precision.
#pragma once

#include <array>
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

}  // namespace meshhier::texture
