// Triangles whose corners name their tile: comparable between the tiles of a level.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "hierarchy/triangle.h"

#include <cstdint>
#include <vector>

namespace meshhier::inspection {

/// NodeId::index of a tile in the upper half, one of its own places in the lower.
enum class Corner : std::uint64_t {};

using CornerTriangle = Triangle<Corner>;

constexpr Corner make_corner(std::uint32_t tile, std::uint32_t vertex) {
  return static_cast<Corner>(std::uint64_t{tile} << 32 | vertex);
}
constexpr std::uint32_t tile_index(Corner corner) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(corner) >> 32);
}
constexpr std::uint32_t vertex_index(Corner corner) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(corner));
}

/// Turns triangles so that equal ones begin alike, and sorts them. `unique`: drops degenerate ones,
/// and of equal ones all but one.
void normalize(std::vector<CornerTriangle>& triangles, bool unique);

/// The tile's border triangles with ghosts as places of their own tiles, normalized: of a partition
/// all, of other tiles the `unique` ones.
std::vector<CornerTriangle> border_of(const PublishedTile& tile, const Tree& tree);

/// The border triangles that the early node above a partition would have. Requires that
/// tile.node is a partition whose parent is early.
std::vector<CornerTriangle> early_border_of(const PublishedTile& tile, const Tree& tree);

}  // namespace meshhier::inspection
