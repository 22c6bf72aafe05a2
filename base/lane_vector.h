// Vectors of three in the first lanes of four floats; the last lane is 0, or is not looked at.
#pragma once

#include "base/four_floats.h"
#include "base/vec.h"

#include <cmath>
#include <limits>

namespace meshhier {

inline FourFloats lanes_of(const Vec3f& v) {
  return FourFloats{v.x, v.y, v.z, 0};
}
inline FourFloats lanes_of(const Vec3d& v) {
  return lanes_of(to_float(v));
}
inline Vec3f vector_of(FourFloats lanes) {
  return {lanes[0], lanes[1], lanes[2]};
}

inline float dot_of(FourFloats a, FourFloats b) {
  const FourFloats product = a * b;
  return (product[0] + product[1]) + product[2];
}

/// Returns the vector scaled to length 1; 0 if it has no length.
inline FourFloats unit_of(FourFloats lanes) {
  const float squared = dot_of(lanes, lanes);
  if (squared >= std::numeric_limits<float>::min() && squared <= std::numeric_limits<float>::max())
    return lanes * (1 / std::sqrt(squared));
  const Vec3d wide = to_double(vector_of(lanes));
  const double size = length(wide);
  return size > 0 ? lanes_of(wide * (1 / size)) : FourFloats{};
}

}  // namespace meshhier
