// In which direction a node is split.
#pragma once

#include "hierarchy/vec.h"
#include "partition/split_plane.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

enum class Axis {
  longest,      ///< the longest axis of the bounding box (Kim & Lee)
  compactness,  ///< of the axes, their diagonals and the principal axes: where the cut is shortest
};

/// A triangle by its corners.
using Corners = std::array<IdPoint, 3>;

/// Candidate directions for these points: `longest` gives one; `compactness` the three axes, the
/// six diagonals of two axes, and the three principal axes of the points. Unit length not required
/// by callers. O(n), deterministic in the order of the points.
std::vector<Vec3d> candidate_directions(std::span<const Vec3f> points, Axis axis);

/// The candidate that cuts the surface shortest, judged by points alone: where the points are
/// thinnest around the quantile `fraction` (0..1), per unit of length. For nodes whose triangles
/// are not at hand. O(c n log n).
Vec3d thinnest_direction(std::span<const Vec3f> points, double fraction,
                         std::span<const Vec3d> candidates);

/// The candidate whose cut at the quantile `fraction` of `points` is shortest over `triangles`: a
/// cut runs through a triangle from the midpoints of the crossing edges to its centroid. Sides are
/// told as splits tell them, ties by id: a direction along which many points are equal is no short
/// cut. Independent of the triangles' order: lengths are summed as integers. O(c (n + t)).
Vec3d shortest_cut_direction(std::span<const IdPoint> points, std::span<const Corners> triangles,
                             double fraction, std::span<const Vec3d> candidates);

}  // namespace meshhier::partition
