// Whether three axes span no space.
#pragma once

#include "base/vec.h"

#include <cmath>

namespace meshhier {

/// Whether they lie in a plane, but for what doubles round; also if one is not a number.
inline bool are_flat(Vec3d x, Vec3d y, Vec3d z) {
  constexpr double kRounding = 1e-14;
  return !(std::abs(dot(x, cross(y, z))) > kRounding * length(x) * length(y) * length(z));
}

}  // namespace meshhier
