// Areas of triangles.
#pragma once

#include "hierarchy/vec.h"

namespace meshhier {

/// Twice the area of a triangle, from its two shorter edges: in a needle the two long ones agree in
/// all digits that a double has, and their cross product is nothing but rounding.
inline double doubled_area(Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d ab = b - a, bc = c - b, ca = a - c;
  const double c_side = dot(ab, ab), a_side = dot(bc, bc), b_side = dot(ca, ca);
  if (c_side >= a_side && c_side >= b_side)
    return length(cross(bc, ca));
  return length(a_side >= b_side ? cross(ca, ab) : cross(ab, bc));
}
inline double doubled_area(Vec3f a, Vec3f b, Vec3f c) {
  return doubled_area(to_double(a), to_double(b), to_double(c));
}

}  // namespace meshhier
