// A tile: the mesh that stands for a node.
//
// Its topology is by place: a place is where one or several vertices lie, which differ in their
// attributes at most. Attributes belong to wedges (Hoppe 1996): a wedge is one vertex at a place.
// `vertices` has the first wedge of each place, `copies` has the others; most meshes have none.
//
// Places [0, own_count) are the tile's own, the rest are ghosts: corners of border triangles that
// belong to neighbouring tiles of the same level. The own places that border triangles use come
// first, within the boundary, [0, boundary_count). The boundary may hold a few more: those of
// border triangles that a neighbour's contraction made degenerate.
#pragma once

#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "hierarchy/ids.h"
#include "hierarchy/triangle.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier {

/// Its corners are places of one tile.
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
  /// Drops all channels but the first `count`. O(n).
  void keep_channels(int count);
};

/// A vertex of another tile of the same level.
struct GhostRef {
  std::uint32_t tile = 0;   ///< NodeId::index of that tile
  std::uint32_t index = 0;  ///< its TileVertex there, below that tile's boundary_count
  friend constexpr auto operator<=>(const GhostRef&, const GhostRef&) = default;
};
static_assert(sizeof(GhostRef) == 8);

/// The wedge that each corner of a triangle has at its place: 0 the place's vertex, k its k-th
/// copy.
using CornerWedges = std::array<std::uint32_t, 3>;

/// Vertices at places that have one already.
struct Copies {
  VertexArray vertices;               ///< of equal position, but for the sign of a zero
  std::vector<std::uint32_t> places;  ///< where each of them lies; ascending

  std::size_t size() const { return places.size(); }
  bool empty() const { return places.empty(); }
  /// The first copy of the first place from `place` on. O(log n).
  std::size_t first_of(std::uint32_t place) const {
    return static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), place) -
                                    places.begin());
  }
};

/// The copies in the order of their places; those of a place keep theirs. O(n log n).
Copies sorted_by_place(const Copies& copies);
/// The copies once each place p has become place[p]. O(n log n).
Copies renumbered(Copies copies, std::span<const std::uint32_t> place);

struct TileMesh {
  VertexArray vertices;  ///< own, then ghosts
  std::uint32_t own_count = 0;
  std::uint32_t boundary_count = 0;    ///< <= own_count
  std::vector<GhostRef> ghosts;        ///< vertices.size() - own_count, ascending, without repeats
  std::vector<TileTriangle> interior;  ///< all corners own; ascending, smallest corner first
  std::vector<TileTriangle> border;    ///< one or two corners own, the others ghosts; likewise
  Copies copies;                       ///< of own places, then of ghosts
  /// Per copy of a ghost, its wedge in the ghost's own tile, >= 1, ascending within a place: only
  /// wedges that border triangles here use are here. Empty in tiles read from a hierarchy.
  std::vector<std::uint32_t> ghost_wedges;
  std::vector<CornerWedges> interior_wedges;  ///< one a triangle; empty if there are no copies
  std::vector<CornerWedges> border_wedges;    ///< likewise

  bool is_own(TileVertex v) const { return raw(v) < own_count; }
  const GhostRef& ghost(TileVertex v) const { return ghosts[raw(v) - own_count]; }
};

/// Drops degenerate triangles, makes the rest canonical() and sorts them. Exact duplicates
/// (same corners, same orientation) lose all but one copy if `unique`; mirror images always stay.
/// O(t log t), deterministic.
void normalize_triangles(std::vector<TileTriangle>& triangles, bool unique);

/// Likewise for triangles with wedges, one entry each; as above if there are none. A triangle
/// begins with its smallest corner by place and wedge, and triangles of equal places ascend by
/// their wedges. `unique`: triangles are equal if their places are, and degenerate if a place is
/// there twice. Otherwise they are only if wedges are equal, too: a partition keeps all of the
/// input's.
void normalize_triangles(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges,
                         bool unique);

}  // namespace meshhier
