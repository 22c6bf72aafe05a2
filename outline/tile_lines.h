// Finds the parts of the mesh's own borders and creases that one tile knows.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace meshhier::outline {

/// Pairs of vertices: (lower, higher).
using Edges = std::vector<std::array<std::uint32_t, 2>>;

/// A tile's part of the mesh's own borders and creases, small for soups that are nothing but
/// borders: the boundary (where crossing borders end), then the other vertices on own borders and
/// creases, ascending.
struct TileLines {
  std::uint32_t tile = 0;
  std::uint32_t boundary_count = 0;
  std::vector<std::uint32_t> inner;  ///< of the other vertices, which they are
  std::vector<Vec3f> positions;
  Edges borders;  ///< of positions, without those that cross from sector to sector
  Edges creases;  ///< of positions
};

/// Lines of the tile with the NodeId::index `tile_index`. `is_crossing(a, b)`: whether own vertices
/// lie in different sectors. O(t) for t triangles whose vertices have bounded degree.
TileLines lines_of(std::uint32_t tile_index, const TileMesh& tile,
                   const std::function<bool(std::uint32_t, std::uint32_t)>& is_crossing);

}  // namespace meshhier::outline
