// Where to begin with a triangle that may be a needle.
#pragma once

#include "base/vec.h"

#include <array>

namespace meshhier {

/// A triangle with the corner opposite its longest edge first. The edges from there are the shorter
/// ones. In a needle the two long edges agree in all digits that a double has: their cross product
/// is nothing but rounding, and so is a place measured along them.
inline std::array<Vec3d, 3> widest_first(Vec3d a, Vec3d b, Vec3d c) {
  const auto square = [](Vec3d edge) { return dot(edge, edge); };
  const double ab = square(b - a), bc = square(c - b), ca = square(a - c);
  if (bc >= ab && bc >= ca)
    return {a, b, c};
  if (ca >= ab)
    return {b, c, a};
  return {c, a, b};
}
inline std::array<Vec3d, 3> widest_first(Vec3f a, Vec3f b, Vec3f c) {
  return widest_first(to_double(a), to_double(b), to_double(c));
}

/// Twice the area of a triangle.
inline double doubled_area(Vec3f a, Vec3f b, Vec3f c) {
  const auto [first, second, third] = widest_first(a, b, c);
  return length(cross(second - first, third - first));
}

}  // namespace meshhier
