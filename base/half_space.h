// Half-spaces, and triangles that touch what several of them have in common.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <array>
#include <span>

namespace meshhier {

/// Where dot(normal, p) <= offset.
struct HalfSpace {
  Vec3d normal;
  double offset = 0;

  double beyond(Vec3d p) const { return dot(normal, p) - offset; }
};

/// Those that have a box in common, its faces included.
std::array<HalfSpace, 6> half_spaces_of(const BoundsD& box);

/// Whether a point of the triangle lies in all half-spaces: a corner or an edge on a face is
/// enough. A point counts that is beyond by no more than rounding moves a point of an edge. O(n^2)
/// of n half-spaces.
bool touches(std::span<const HalfSpace> half_spaces, const std::array<Vec3d, 3>& corners);

}  // namespace meshhier
