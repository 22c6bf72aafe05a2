// Normals in four bytes, as glTF has them with KHR_mesh_quantization.
#pragma once

#include "base/vec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace meshhier {

/// A direction: x, y and z, each 127 times its value and rounded to the nearest, then 0. It is off
/// by 0.4 degrees at most.
using NormalCode = std::array<std::int8_t, 4>;
static_assert(sizeof(NormalCode) == 4);

/// A normal without a direction looks along z.
inline constexpr NormalCode kNoDirection{0, 0, 127, 0};

/// Whether it is one that normal_code() gives, or as near to unit length as those are: half a step
/// off on each axis is 0.0068 of the length.
inline bool is_normal_code(const NormalCode& code) {
  const Vec3d direction{static_cast<double>(code[0]), static_cast<double>(code[1]),
                        static_cast<double>(code[2])};
  const bool in_range = std::ranges::min(code) >= -127 && code[3] == 0;
  return in_range && std::abs(length(direction) / 127 - 1) <= 0.0068;
}

/// The code of a vector of any length; kNoDirection if that is 0 or not finite. A normal that came
/// from a code, which is not quite of unit length, has that code again.
inline NormalCode normal_code(const Vec3d& normal) {
  const double size = length(normal);
  if (!(size > 0) || !std::isfinite(size))
    return kNoDirection;
  const auto rounded = [](const Vec3d& steps) -> NormalCode {
    const auto axis = [](double value) {
      return static_cast<std::int8_t>(static_cast<int>(value + std::copysign(0.5, value)));
    };
    return {axis(steps.x), axis(steps.y), axis(steps.z), 0};
  };
  const auto is_at = [](const NormalCode& code, const Vec3d& steps) {
    constexpr double kFloatError = 1e-4;
    return std::abs(code[0] - steps.x) <= kFloatError &&
           std::abs(code[1] - steps.y) <= kFloatError && std::abs(code[2] - steps.z) <= kFloatError;
  };
  if (std::abs(size - 1) <= 0.007) {
    const NormalCode code = rounded(normal * 127);
    if (is_at(code, normal * 127) && is_normal_code(code))
      return code;
  }
  return rounded(normal * (127 / size));
}

/// The normal of a code; its length is from 0.993 to 1.007.
inline Vec3f normal_of(const NormalCode& code) {
  constexpr float kStep = 1 / 127.0F;
  return {static_cast<float>(code[0]) * kStep, static_cast<float>(code[1]) * kStep,
          static_cast<float>(code[2]) * kStep};
}

}  // namespace meshhier
