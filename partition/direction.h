// In which direction a node is split.
#pragma once

#include "base/vec.h"

#include <span>
#include <vector>

namespace meshhier::partition {

enum class Axis {
  longest,      ///< the longest axis of the bounding box (Kim & Lee)
  compactness,  ///< of the axes, their diagonals and the principal axes: where the cut is shortest;
                ///< within chunks, lines that follow the surface
};

/// Candidate directions for these points: `longest` gives one; `compactness` the three axes, the
/// six diagonals of two axes, and the three principal axes of the points. Unit length not required
/// by callers. O(n), deterministic in the order of the points.
std::vector<Vec3d> candidate_directions(std::span<const Vec3f> points, Axis axis);

/// The candidate that cuts the surface shortest, judged by points alone: where the points are
/// thinnest around the quantile `fraction` (0..1), per unit of length; on a choice of them. For
/// nodes whose triangles are not at hand. O(n + c).
Vec3d thinnest_direction(std::span<const Vec3f> points, double fraction,
                         std::span<const Vec3d> candidates);

}  // namespace meshhier::partition
