// The normals of all of a tile's vertices, ghosts and all, and of all corners.
#pragma once

#include "hierarchy/build_tile.h"
#include "hierarchy/shading.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::shading {

/// Returns the part of a tile's normals that its neighbours see. Pure.
BoundaryShading boundary_of(const OwnShading& shading, const TileMesh& mesh);

/// The same normals once place p has become place[p]. `copy_places`: of the tile's copies, as they
/// were: those of own places come first, and are sorted by their new places.
OwnShading renumbered(const OwnShading& shading, std::span<const std::uint32_t> copy_places,
                      std::span<const std::uint32_t> place, std::uint32_t own_count);

/// A corner of a vertex with several normals takes the one that is nearest to its triangle's own:
/// so all tiles that have the triangle agree. Splits that no corner takes are left out.
/// `neighbour`: what a tile shows that has ghosts here. Pure, deterministic; O(n log n). Throws
/// Error(internal) if a ghost is not on its tile's boundary.
Shading shade_tile(const TileMesh& mesh, const OwnShading& own,
                   const std::function<BoundaryShading(std::uint32_t tile)>& neighbour);

}  // namespace meshhier::shading
