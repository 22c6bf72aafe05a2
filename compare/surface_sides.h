// The sides of a surface that points are on, by its pseudo-normals (Bærentzen & Aanæs, Signed
// Distance Computation Using the Angle Weighted Pseudonormal, 2005).
#pragma once

#include "base/vec.h"
#include "compare/cut_surface.h"
#include "compare/surface_distance.h"
#include "execution/cancel.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::comparing {

enum class Side : std::uint8_t {
  outside,  ///< on the side that normals point to, or on the surface
  inside,
  unknown  ///< the nearest point is on a border of the surface, or it has no normal there
};

/// Returns the sides of points; `nearest` are their nearest triangles, and `trees` those of the
/// surface's tiles. The nearest point lies on a face, an edge or a vertex: its normal is the sum of
/// the normals of all triangles there, for a vertex times their angles; they may be those of
/// several tiles. A vertex or edge where an edge has not two triangles is a border, or no manifold:
/// the side is unknown. Parallel; the result depends on points and surface alone. Throws as
/// SurfaceDistance.
std::vector<Side> surface_sides(const CutSurface& surface, TreeCache& trees,
                                std::span<const Vec3d> points,
                                std::span<const NearestOnSurface> nearest,
                                const execution::CancelToken& cancel);

}  // namespace meshhier::comparing
