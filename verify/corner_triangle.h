// Triangles whose corners name their tile: comparable between the tiles of a level.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "hierarchy/triangle.h"

#include <cstdint>
#include <vector>

namespace meshhier::verifying {

/// NodeId::index of a tile in the upper half, one of its own places in the lower.
enum class CornerId : std::uint64_t {};

using CornerTriangle = Triangle<CornerId>;

constexpr CornerId make_corner(std::uint32_t tile, std::uint32_t vertex) {
  return static_cast<CornerId>(std::uint64_t{tile} << 32 | vertex);
}
constexpr std::uint32_t tile_index(CornerId corner) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(corner) >> 32);
}
constexpr std::uint32_t vertex_index(CornerId corner) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(corner));
}

/// A triangle with the computed normals of its corners, as numbers; 0 where there are none.
struct ShadedTriangle {
  CornerTriangle corners;
  Triangle<std::uint64_t> normals{};
  friend constexpr auto operator<=>(const ShadedTriangle&, const ShadedTriangle&) = default;
};
static_assert(sizeof(ShadedTriangle) == 48, "hashed by bytes: no padding");

/// Turns triangles so that equal ones begin alike, and sorts them. `unique`: drops degenerate ones,
/// and of those with equal corners all but one.
void normalize(std::vector<CornerTriangle>& triangles, bool unique);
void normalize(std::vector<ShadedTriangle>& triangles, bool unique);

/// Returns the tile's border triangles with ghosts as places of their own tiles, normalized: all of
/// a partition, the `unique` ones of other tiles.
std::vector<ShadedTriangle> border_of(const PublishedTile& tile, const Tree& tree);

/// Returns the border triangles that the early node above a partition would have, without normals.
/// Requires that tile.node is a partition whose parent is early.
std::vector<ShadedTriangle> early_border_of(const PublishedTile& tile, const Tree& tree);

}  // namespace meshhier::verifying
