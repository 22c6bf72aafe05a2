// Distances to triangles and between segments, certain as upper bounds.
//
// Every result is the distance to a point that was built inside the triangle or segment, so however
// badly conditioned the search for the closest point was, it is never below the true distance by
// more than the rounding of a few sums (kRounding, deviation.h). Double precision holds the
// products of six float coordinates over the whole range of float: nothing overflows or vanishes.
#pragma once

#include "hierarchy/vec.h"

namespace meshhier::cluster_simplify {

/// A triangle by one corner and two edges, with the products every query needs.
struct TriangleFrame {
  Vec3d a, ab, ac;
  double bb = 0, bc = 0, cc = 0;  ///< ab.ab, ab.ac, ac.ac

  TriangleFrame(Vec3d pa, Vec3d pb, Vec3d pc)
      : a(pa), ab(pb - pa), ac(pc - pa), bb(dot(ab, ab)), bc(dot(ab, ac)), cc(dot(ac, ac)) {}
};

/// Squared distance from `x` to the triangle; degenerate triangles are segments or points.
double squared_distance(Vec3d x, const TriangleFrame& triangle);

/// The part of a triangle that holds a point. Edge i runs from corner i to the next, the corners
/// being a, b, c.
enum class Feature : unsigned char { inside, edge_0, edge_1, edge_2, corner_0, corner_1, corner_2 };

struct ClosestPoint {
  Vec3d point;
  double squared_distance = 0;
  Feature feature = Feature::inside;
};
ClosestPoint closest_point(Vec3d x, const TriangleFrame& triangle);

/// The foot of a perpendicular on a triangle's plane.
struct PlaneFoot {
  Vec3d point;
  double squared_distance = 0;
  bool inside = false;  ///< strictly within the triangle; false if it has no area
};
PlaneFoot plane_foot(Vec3d x, const TriangleFrame& triangle);

struct Segment {
  Vec3d start, direction;
};

/// Where two segments come closest.
struct Encounter {
  double on_first = 0, on_second = 0;  ///< parts of their directions, in [0, 1]
  double squared_distance = 0;         ///< between those two points
};

/// Two segments' directions, the way from one start to the other, and their products.
struct SegmentPair {
  Vec3d d, e, r;
  double dd, ee, de, dr, er;

  SegmentPair(const Segment& first, const Segment& second)
      : d(first.direction),
        e(second.direction),
        r(first.start - second.start),
        dd(dot(d, d)),
        ee(dot(e, e)),
        de(dot(d, e)),
        dr(dot(d, r)),
        er(dot(e, r)) {}
};
/// For segments that come closest at an end of one of them, or are parallel.
Encounter closest_at_ends(const SegmentPair& pair);

inline Encounter closest(const Segment& first, const Segment& second) {
  const SegmentPair pair(first, second);
  const auto& [d, e, r, dd, ee, de, dr, er] = pair;
  const double area = dd * ee - de * de;
  const double s = de * er - dr * ee;
  const double t = dd * er - de * dr;
  // Segments that are nearly parallel lose the crossing in rounding (the squared sine between
  // them).
  constexpr double kParallel = 1e-6;
  if (s <= 0 || t <= 0 || s >= area || t >= area || area <= kParallel * dd * ee)
    return closest_at_ends(pair);
  const double scale = 1 / area;
  const Vec3d gap = r + d * (s * scale) - e * (t * scale);
  return {s * scale, t * scale, dot(gap, gap)};
}

}  // namespace meshhier::cluster_simplify
