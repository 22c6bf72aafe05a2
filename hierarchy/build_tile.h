// Tiles while a hierarchy is being built.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier {

/// The history of a tile's own vertices, one entry each.
struct VertexHistory {
  std::vector<float> weights;  ///< how many original vertices it stands for, >= 1
};

// A tile just made names the foreign corners of its border triangles as they were one step earlier,
// because the neighbours' own maps were not known yet. Kept in scratch space as they are here.

/// A foreign corner of a simplified tile: the ghost that it was one level finer, where its tiles
/// were made from.
struct FinerGhost {
  GhostRef ref;  ///< `tile` counts the nodes one level finer than the tile that has the corner
  friend constexpr auto operator<=>(const FinerGhost&, const FinerGhost&) = default;
};
static_assert(sizeof(FinerGhost) == 8);

/// A foreign corner of a partition: a vertex of a chunk (partition/chunk.h) that was not split yet.
struct ChunkVertex {
  std::uint32_t chunk = 0;  ///< NodeId::index of the chunk
  std::uint32_t local = 0;  ///< provisional rank within the chunk
  friend constexpr auto operator<=>(const ChunkVertex&, const ChunkVertex&) = default;
};
static_assert(sizeof(ChunkVertex) == 8);

/// A tile just made, its foreign corners named by `Corner`.
template <class Corner>
struct WorkTile {
  VertexArray vertices;   ///< own only, boundary first
  VertexHistory history;  ///< own only
  std::uint32_t boundary_count = 0;
  std::vector<TileTriangle> interior;
  std::vector<TileTriangle>
      border;  ///< corners from vertices.size() on: foreign[corner - vertices.size()]
  std::vector<Corner> foreign;  ///< ascending, without repeats
  Copies copies;                ///< of own places
  /// As TileMesh's; of a foreign corner its wedge in its own tile where it was named.
  std::vector<CornerWedges> interior_wedges, border_wedges;
};

using LeafTile = WorkTile<ChunkVertex>;       ///< of a partition
using SimplifiedTile = WorkTile<FinerGhost>;  ///< of a node above

/// The part of a tile that its neighbours see: its boundary vertices, [0, boundary_count).
struct Boundary {
  VertexArray vertices;
  Copies copies;
};

/// Maps the wedges of a tile's own places to those of its parent: each to a wedge at the place that
/// stands for its own, which the parent map names. Empty if all have kept their numbers.
struct WedgeMap {
  std::vector<std::uint32_t> firsts;  ///< of the vertex of each place
  std::vector<std::uint32_t> copies;  ///< of each copy
  std::vector<std::uint32_t> places;  ///< of each copy, as Copies::places

  bool empty() const { return firsts.empty(); }
  /// O(log n).
  std::uint32_t operator()(std::uint32_t place, std::uint32_t wedge) const {
    if (firsts.empty())
      return wedge;
    if (wedge == 0)
      return firsts[place];
    const auto first = std::lower_bound(places.begin(), places.end(), place) - places.begin();
    return copies[static_cast<std::size_t>(first) + wedge - 1];
  }
};

/// A tile whose ghosts are known at its own level, with what contraction needs of them.
struct BuildTile {
  TileMesh mesh;
  VertexHistory history;  ///< own
};

/// The part of a simplified tile that its neighbours measure against: its border triangles as they
/// were when it was made, foreign corners where they had been one level finer, and the interior
/// triangles at its boundary.
struct SeamStrip {
  std::uint32_t boundary_count = 0;
  std::uint32_t own_count = 0;      ///< own vertices in the seam strip, boundary first
  std::vector<Vec3f> positions;     ///< own, then foreign
  std::vector<float> deviations;    ///< of own ones: what the triangles around them may have moved
  std::vector<FinerGhost> foreign;  ///< as WorkTile::foreign
  std::vector<TileTriangle> interior;  ///< with a corner in the boundary
  std::vector<TileTriangle> border;
  float interior_deviation = 0;  ///< the largest of all interior triangles of the tile
  float lost = 0;                ///< see cluster_simplify::Deviation
  double mean_square = 0;        ///< likewise
};

}  // namespace meshhier
