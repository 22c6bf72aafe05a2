// On which side of a surface points are, by its pseudo-normals (Bærentzen & Aanæs, Signed Distance
// Computation Using the Angle Weighted Pseudonormal, 2005).
#pragma once

#include "compare/cut_surface.h"
#include "compare/surface_distance.h"
#include "execution/cancel.h"
#include "hierarchy/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::comparing {

enum class Side : std::uint8_t {
  outside,  ///< where normals point, or on the surface
  inside,
  unknown  ///< the nearest point is on a border of the surface, or it has no normal there
};

/// The sides of points whose nearest triangles `trees` holds. What the nearest point lies on, a
/// face, an edge or a vertex, has the sum of the normals of all triangles there, those of a vertex
/// times their angles; they may be those of several tiles. A vertex or edge where an edge has not
/// two triangles is a border, or no manifold. Parallel; the result depends on points and surface
/// alone. Throws as SurfaceDistance.
std::vector<Side> surface_sides(const CutSurface& surface, TreeCache& trees,
                                std::span<const Vec3d> points,
                                std::span<const NearestTriangle> nearest,
                                const execution::CancelToken& cancel);

}  // namespace meshhier::comparing
