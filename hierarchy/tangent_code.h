// Tangents in four bytes, as glTF has them with KHR_mesh_quantization.
#pragma once

#include "base/vec.h"
#include "hierarchy/normal_code.h"

#include <array>
#include <cstdint>
#include <cstdlib>

namespace meshhier {

/// A direction as NormalCode has it, and 127 or -127: on which side of it, seen along the normal,
/// the bitangent is (cross(normal, tangent) times 1 or -1).
using TangentCode = std::array<std::int8_t, 4>;

/// The tangent of a vertex that no triangle uses.
inline constexpr TangentCode kNoTangent{127, 0, 0, 127};

inline TangentCode tangent_code(const Vec3d& tangent, bool is_mirrored) {
  NormalCode code = normal_code(tangent);
  code[3] = is_mirrored ? -127 : 127;
  return code;
}

/// Whether it is one that tangent_code() gives.
inline bool is_tangent_code(const TangentCode& code) {
  return std::abs(int{code[3]}) == 127 && is_normal_code({code[0], code[1], code[2], 0});
}

}  // namespace meshhier
