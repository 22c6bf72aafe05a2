// Large polygons as triangles, in n log n.
//
// Problem. Ears take a polygon of n corners apart in n^2; maps have polygons of 100,000 corners. A
// polygon with holes comes as one line that runs to each hole and back, so it touches itself.
//
// Idea. All corners go into a constrained Delaunay triangulation with the polygon's edges as
// constraints. Each triangle knows how often the polygon winds around it: the outside has 0, and
// crossing an edge adds 1 or takes 1 away, by the edge's direction. The triangles inside are the
// answer:
//
//            0                       An edge that runs there and back, to a hole and from it,
//       +----------------+           adds nothing: the triangles on both sides have the same
//       |  1    +---+    |           winding. So the slit needs no rule of its own.
//       |       | 0 |    |
//       |=======+---+  1 |           Crossing edges have no place in such a triangulation, which
//       |  1             |           says so; a winding other than 0 and `sign` means that the
//       +----------------+           polygon turns back over itself. Both are "no cover".
//
// Several corners may lie at one place (both ends of the slit). The triangulation has one vertex
// there; a triangle gets the number of the corner in whose angle it lies, so that attributes of
// corners stay on their side.
//
// Invariant. All decisions are exact predicates on the corners as they are: the triangles' areas
// add up to the polygon's, and no point is added.
//
// Cost. O(n log n) typically: sorting the corners, inserting them along a curve, one walk over the
// faces.
#pragma once

#include "hierarchy/triangle.h"
#include "mesh_io/polygon_turns.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// Returns triangles of corners' numbers that cover the polygon exactly and turn as it does: those
/// of a constrained Delaunay triangulation (CGAL) that lie within. The polygon may touch itself, as
/// around holes; where several corners are at one place, the one is named whose angle the triangle
/// lies in. `sign`: 1 if it turns to the left, -1 if to the right. Returns none if it crosses
/// itself, winds more than once, or has all corners on a line. The result depends on the corners
/// alone. Requires finite ones. Typically O(n log n). Thread-safe.
std::optional<std::vector<Triangle<std::uint32_t>>> cover_polygon(std::span<const Point2> corners,
                                                                  int sign);

}  // namespace meshhier::mesh_io
