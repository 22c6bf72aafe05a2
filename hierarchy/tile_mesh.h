// A tile: the mesh that stands for a node.
//
// Vertices [0, own_count) are the tile's own, the rest are ghosts: corners of border triangles that
// belong to neighbouring tiles of the same level. The own vertices that border triangles use come
// first, within the boundary, [0, boundary_count). The boundary may hold a few more: those of
// border triangles that a neighbour's contraction made degenerate.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/ids.h"
#include "hierarchy/triangle.h"
#include "hierarchy/vec.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier {

/// Its corners are vertices of one tile.
using TileTriangle = Triangle<TileVertex>;

/// Positions and attributes of n vertices, each as one flat array.
struct VertexArray {
  std::vector<Vec3f> positions;   ///< n, relative to the hierarchy's origin
  std::vector<float> attributes;  ///< n * channels, see attributes.h
  int channels = 0;

  std::size_t size() const { return positions.size(); }
  std::span<const float> attributes_of(std::size_t vertex) const {
    return {attributes.data() + vertex * static_cast<std::size_t>(channels),
            static_cast<std::size_t>(channels)};
  }
  void reserve(std::size_t count);
  void append(Vec3f position, std::span<const float> vertex_attributes);
  void append(const VertexArray& other, std::size_t begin, std::size_t end);
  /// Appends those of another array, with the same channels, in the order they are named.
  void append(const VertexArray& other, std::span<const std::uint32_t> vertices);
};

/// A vertex of another tile of the same level.
struct GhostRef {
  std::uint32_t tile = 0;   ///< NodeId::index of that tile
  std::uint32_t index = 0;  ///< its TileVertex there, below that tile's boundary_count
  friend constexpr auto operator<=>(const GhostRef&, const GhostRef&) = default;
};
static_assert(sizeof(GhostRef) == 8);

struct TileMesh {
  VertexArray vertices;  ///< own, then ghosts
  std::uint32_t own_count = 0;
  std::uint32_t boundary_count = 0;    ///< <= own_count
  std::vector<GhostRef> ghosts;        ///< vertices.size() - own_count, ascending, without repeats
  std::vector<TileTriangle> interior;  ///< all corners own; ascending, smallest corner first
  std::vector<TileTriangle> border;    ///< one or two corners own, the others ghosts; likewise

  bool is_own(TileVertex v) const { return raw(v) < own_count; }
  const GhostRef& ghost(TileVertex v) const { return ghosts[raw(v) - own_count]; }
};

/// Drops degenerate triangles, makes the rest canonical() and sorts them. Exact duplicates
/// (same corners, same orientation) lose all but one copy if `unique`; mirror images always stay.
/// O(t log t), deterministic.
void normalize_triangles(std::vector<TileTriangle>& triangles, bool unique);

}  // namespace meshhier
