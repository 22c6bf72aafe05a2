// Wedges across seams: does with the wedges of a tile's corners what seams.h does with places.
//
// Problem. A tile names wedges of its own places by their numbers; those of a ghost by the copies
// that it has of it, which are fewer than the ghost's own tile has. So one wedge has two numbers,
// and they must be translated whenever a ghost changes hands:
//
//      in the ghost's own tile:     wedge     0    1    2    3    4
//      border triangles here use:             0         2         4
//      copies here:                           0         1         2      local numbers
//      TileMesh::ghost_wedges:                          2    4           per copy, ascending
//
//      own number   -- number_ghost_wedges() -->                   local number
//      local number -- name_ghost_wedges(), wedges_of_images() --> own number
//      local number in one tile -- joined_wedges() -->             local number in the joined one
//
// Invariant. Between apply() and resolve() a foreign corner's wedge has the number of the ghost's
// own tile, which all tiles agree on; in a tile with ghosts it has the local one.
#pragma once

#include "hierarchy/build_tile.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

struct ContractedTile;

/// Makes the copies that border triangles use of ghosts, without their vertices: until now these
/// triangles name wedges as the ghosts' own tiles do. O(n log n).
void number_ghost_wedges(TileMesh& mesh);

/// The inverse for the wedges of the border triangles of `mesh`: those of ghosts are named as in
/// the ghosts' own tiles.
void name_ghost_wedges(const TileMesh& mesh, std::vector<CornerWedges>& border_wedges);

/// Appends the vertices of the copies of the ghosts that were filled last, all of one neighbour.
/// Throws Error(internal) if it does not have them.
void fill_ghost_copies(TileMesh& mesh, const Boundary& boundary);

/// Gives `joined`, whose places are there, the copies of both tiles. `second_index`, `first_index`:
/// ghosts of the first tile in the second, and the other way round, are own places now.
void join_copies(const TileMesh& first, std::uint32_t second_index, const TileMesh& second,
                 std::uint32_t first_index, TileMesh& joined);

/// The wedges of a border triangle of either tile in the joined one; `placed`: its places there.
CornerWedges joined_wedges(const TileMesh& tile, std::size_t border, const TileTriangle& placed,
                           const TileMesh& joined);

/// Appends the wedges of `count` triangles; all 0 if there are none.
void append_wedges(std::size_t count, std::span<const CornerWedges> wedges,
                   std::vector<CornerWedges>& to);

/// Removes triangles that have a place twice: only partitions have them.
void drop_degenerate(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges);

/// The wedges of the triangles that keep an area in the contracted tile, in their order; those of
/// foreign corners are named as in the tiles of `joined`'s ghosts. `contracted`: with its maps.
std::vector<CornerWedges> wedges_of_images(const TileMesh& joined,
                                           std::span<const TileTriangle> triangles,
                                           std::span<const CornerWedges> wedges,
                                           const ContractedTile& contracted);

/// Keeps one of the triangles of the same places, and drops and sorts as normalize_triangles()
/// does. The choice does not depend on how a tile numbers its vertices: the wedges are compared in
/// the order of the corners' names in their own tiles, `ref`. O(n log n).
void keep_one_of_places(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges,
                        const std::function<GhostRef(TileVertex)>& ref);

/// Keeps one of neighbours that are equal, wedges and all.
void drop_equal(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges);

}  // namespace meshhier::cluster_simplify
