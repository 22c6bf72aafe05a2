// Large polygons as triangles, in n log n.
#pragma once

#include "hierarchy/triangle.h"
#include "mesh_io/polygon_turns.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// Triangles of numbers of corners that cover the polygon exactly and turn as it does: those of a
/// constrained Delaunay triangulation (CGAL) that lie within. The polygon may touch itself, as
/// around holes; where several corners are at one place, the one is named whose angle the triangle
/// lies in. `sign`: 1 if it turns to the left, -1 if to the right. None if it crosses itself or
/// winds more than once. The result depends on the corners alone. Requires finite ones. Typically
/// O(n log n). Thread-safe.
std::optional<std::vector<Triangle<std::uint32_t>>> cover_polygon(std::span<const Point2> corners,
                                                                  int sign);

}  // namespace meshhier::mesh_io
