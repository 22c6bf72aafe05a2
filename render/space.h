// Vectors of space.
#pragma once

#include "base/vec.h"

#include <cmath>

namespace meshhier::render {

/// The same direction, of length 1. Requires that it has one.
inline Vec3d unit(Vec3d vector) {
  return vector * (1 / length(vector));
}

}  // namespace meshhier::render
