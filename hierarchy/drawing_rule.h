// The drawing rule as functions: which tile of a cut draws a border triangle. The rule itself
// stands at PublishedTile (hierarchy/published.h).
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/tree.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace meshhier {

/// Whether `tile` goes before the region of a neighbouring node of its own level that a cut shows
/// at level `shown`.
constexpr bool draws_before(NodeId tile, std::uint32_t neighbour, Level shown) {
  return shown < tile.level || (shown == tile.level && tile.index < neighbour);
}

/// The same in the cut of the tile's own level.
inline bool draws_before(const Tree& tree, NodeId tile, std::uint32_t neighbour) {
  return draws_before(tile, neighbour, tree.tile_node({tile.level, neighbour}).level);
}

/// Whether a tile draws a border triangle: `before(ghost)` says of each of its ghosts, by the place
/// in mesh.ghosts, whether the tile goes before the ghost's.
template <class Before>
bool draws(const TileMesh& mesh, const TileTriangle& triangle, const Before& before) {
  return std::all_of(triangle.begin(), triangle.end(), [&](TileVertex v) {
    return mesh.is_own(v) || before(std::size_t{raw(v)} - mesh.own_count);
  });
}

/// How many of its border triangles a tile draws in the cut of its own level. O(ghosts + border
/// triangles).
std::uint32_t drawn_border_count(const Tree& tree, NodeId tile, const TileMesh& mesh);

}  // namespace meshhier
