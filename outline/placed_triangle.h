// Triangles with corners in several sectors, over all tiles.
#pragma once

#include "base/vec.h"
#include "hierarchy/triangle.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace meshhier::outline {

/// A vertex over all tiles: tile << 32 | index in it.
using VertexKey = std::uint64_t;

inline std::uint32_t tile_of(VertexKey vertex) {
  return static_cast<std::uint32_t>(vertex >> 32);
}

struct PlacedCorner {
  VertexKey key;
  Vec3f position;
  std::uint32_t part;  ///< of the tile
};

inline bool in_one_sector(const PlacedCorner& a, const PlacedCorner& b) {
  return tile_of(a.key) == tile_of(b.key) && a.part == b.part;
}

/// Corners by ascending key: both sides of a line compute its points from the same order.
using PlacedTriangle = std::array<PlacedCorner, 3>;

/// The corners that a triangle's edges join.
inline constexpr std::array<std::array<std::size_t, 2>, 3> kEdges{{{0, 1}, {0, 2}, {1, 2}}};

inline bool is_crossing(const PlacedTriangle& t, std::size_t edge) {
  return !in_one_sector(t[kEdges[edge][0]], t[kEdges[edge][1]]);
}

inline bool touches_three(const PlacedTriangle& t) {
  return is_crossing(t, 0) && is_crossing(t, 1) && is_crossing(t, 2);
}

inline bool touches_one(const PlacedTriangle& t) {
  return !is_crossing(t, 0) && !is_crossing(t, 1);
}

inline Triangle<VertexKey> key_of(const PlacedTriangle& t) {
  return {t[0].key, t[1].key, t[2].key};
}

inline bool before(const PlacedTriangle& a, const PlacedTriangle& b) {
  return key_of(a) < key_of(b);
}

}  // namespace meshhier::outline
