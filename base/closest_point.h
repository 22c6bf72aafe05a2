// Distances to triangles, certain as upper bounds.
//
// Every result is the distance to a point that was built inside the triangle, so however badly
// conditioned the search for the closest point was, it is never below the true distance by more
// than the rounding of a few sums (kDistanceRounding, cluster_simplify/cover_distance.cpp). Double
// precision holds the products of six float coordinates over the whole range of float: nothing
// overflows or vanishes.
#pragma once

#include "base/vec.h"

namespace meshhier {

/// A triangle by one corner and two edges, with the products every query needs.
struct TriangleFrame {
  Vec3d a, ab, ac;
  double bb = 0, bc = 0, cc = 0;  ///< ab.ab, ab.ac, ac.ac

  TriangleFrame(Vec3d pa, Vec3d pb, Vec3d pc)
      : a(pa), ab(pb - pa), ac(pc - pa), bb(dot(ab, ab)), bc(dot(ab, ac)), cc(dot(ac, ac)) {}
};

/// Squared distance from `x` to the triangle; degenerate triangles are segments or points.
double squared_distance(Vec3d x, const TriangleFrame& triangle);

/// Two triangles at a time.
struct TrianglePair {
  using Two = double __attribute__((vector_size(16)));
  Two ax, ay, az, bx, by, bz, cx, cy, cz;  ///< a, ab, ac
  Two bb, bc, cc;

  TrianglePair(const TriangleFrame& s, const TriangleFrame& t)
      : ax{s.a.x, t.a.x},
        ay{s.a.y, t.a.y},
        az{s.a.z, t.a.z},
        bx{s.ab.x, t.ab.x},
        by{s.ab.y, t.ab.y},
        bz{s.ab.z, t.ab.z},
        cx{s.ac.x, t.ac.x},
        cy{s.ac.y, t.ac.y},
        cz{s.ac.z, t.ac.z},
        bb{s.bb, t.bb},
        bc{s.bc, t.bc},
        cc{s.cc, t.cc} {}
};

/// Squared distances from `x` to both, without a branch.
TrianglePair::Two squared_distances(Vec3d x, const TrianglePair& pair);

struct ClosestPoint {
  Vec3d point;
  double squared_distance = 0;
  double on_b = 0, on_c = 0;  ///< a + ab * on_b + ac * on_c is the point; both in [0, 1]
};
/// At a corner on_b and on_c are 0 or 1 exactly.
ClosestPoint closest_point(Vec3d x, const TriangleFrame& triangle);

}  // namespace meshhier
