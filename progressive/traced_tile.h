// A tile of a half_edge hierarchy that knows which vertices and triangles of the original mesh are
// left in it (docs/decisions/008).
//
// Problem. A progressive stream adds, level by level, the vertices and triangles that the level
// before lacks, by their numbers in the original mesh. The hierarchy's files do not tell these.
//
// Idea. Where a contraction moves vertices onto others, every vertex of a tile is one of the
// original mesh, and every triangle the image of one. So tiles are followed from the partitions up:
//
//      left child   right child      each: ranks of its vertices, numbers of its triangles
//             \       /
//              lift()  --------->    losses: vertices moved onto others, triangles that lost their
//                |                   area or became equal to another one
//              parent                ranks and numbers of what is left
//
// Invariants. Each vertex of the sector is lost once, or is left at its node; so is each triangle,
// by the first partition that it touches. If triangles have one image, the first original stays,
// seen from every tile that has them. As many triangles are left as the parent's file has, and each
// vertex is at the place of one that it stands for: else the hierarchy is corrupt.
//
// Cost. O(t log t) a step. All that a step needs is in the three tiles: memory follows the size of
// tiles, not of the mesh.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "hierarchy/triangle.h"

#include <cstdint>
#include <vector>

namespace meshhier::progressive {

// Vertices of the original mesh are ranks; triangles are numbered in the order of sorted_corners()
// below, partition by partition, a triangle in the first partition that it touches.

/// The number of a triangle that a tile before counts.
inline constexpr std::uint64_t kCountedElsewhere = UINT64_MAX;

/// The part of the hierarchy that is followed: a node, as if it were alone.
struct Sector {
  NodeId node;
  RankRange ranks;
  PartitionRange partitions;

  Sector(const Tree& tree, NodeId of)
      : node(of), ranks(tree.ranks(of)), partitions(tree.partitions(of)) {}
  bool has_rank(std::uint32_t rank) const { return rank >= ranks.begin && rank < ranks.end; }
  bool has_partition(std::uint32_t partition) const {
    return partition >= partitions.begin && partition < partitions.end;
  }
};

/// Returns a number by which own vertices of the sector come first, then those of others, each in
/// the order of ranks.
inline std::uint64_t order_of(const Sector& sector, std::uint32_t rank) {
  return sector.has_rank(rank) ? rank : std::uint64_t{rank} + (std::uint64_t{1} << 32);
}

/// Returns what canonical() does, but by order_of().
Triangle<std::uint32_t> sorted_corners(const Sector& sector,
                                       const Triangle<std::uint32_t>& corners);

struct TracedTriangle {
  Triangle<std::uint32_t> corners;  ///< the original triangle's, sorted_corners()
  TileTriangle image;               ///< the tile's vertices that stand for them, one for each
  std::uint64_t index = 0;          ///< in the original mesh, or kCountedElsewhere
};

/// An array of the vertices' values: x, y, z, attributes.
struct VertexValues {
  std::vector<float> values;  ///< width each
  std::size_t width = 3;

  std::span<const float> operator[](std::size_t vertex) const {
    return std::span(values).subspan(vertex * width, width);
  }
  void append(std::span<const float> vertex) {
    values.insert(values.end(), vertex.begin(), vertex.end());
  }
};

struct TracedTile {
  NodeId node;
  std::vector<std::uint32_t> ranks;       ///< which vertex of the original each own vertex is
  VertexValues values;                    ///< theirs
  std::vector<GhostRef> ghosts;           ///< ascending; tile vertices from ranks.size() on
  GhostChains chains;                     ///< one for each ghost, from this tile's level up
  std::vector<std::uint16_t> parent_map;  ///< empty for the root
  std::vector<TracedTriangle> triangles;  ///< all that touch the tile
  std::uint64_t end_index = 0;            ///< behind the last triangle that its partitions count
};

/// Vertices and triangles of a level that the next coarser one has no more, in ascending order.
struct Losses {
  std::vector<std::uint32_t> ranks;
  VertexValues values;
  std::vector<std::uint64_t> triangles;  ///< indices; those counted elsewhere are not there
  std::vector<Triangle<std::uint32_t>> corners;
};

/// Returns the traced tile of a partition; its triangles are counted from `first_index` on. Throws
/// Error(corrupt) if it contradicts itself.
TracedTile trace_partition(const Tree& tree, const Sector& sector, const PublishedTile& tile,
                           std::uint64_t first_index);

/// The result of either step up.
struct Lifted {
  TracedTile tile;
  Losses losses;
};

/// Lifts a partition to its early node: the same vertices, neighbours one level coarser.
Lifted lift_early(const Tree& tree, const Sector& sector, TracedTile partition);

/// Lifts two children to their parent. Throws Error(corrupt) if `parent` is not made of `left` and
/// `right` by moving vertices onto others. O(t log t).
Lifted lift(const Tree& tree, const Sector& sector, TracedTile left, TracedTile right,
            const PublishedTile& parent);

/// Returns all that is left in the tile, as if the next coarser level had nothing.
Losses all_of(const TracedTile& tile);

/// The tile vertices that stand for vertices of the original mesh which the tile's triangles have
/// for corners, and which are no vertices of the tile themselves. Both lists ascend.
struct StandIns {
  struct Own {
    std::uint32_t rank = 0;
    std::uint32_t vertex = 0;  ///< < ranks.size()
    friend auto operator<=>(const Own&, const Own&) = default;
  };
  struct Foreign {
    std::uint32_t rank = 0;   ///< not of the sector
    std::uint32_t ghost = 0;  ///< < ghosts.size()
    friend auto operator<=>(const Foreign&, const Foreign&) = default;
  };
  std::vector<Own> own;
  std::vector<Foreign> foreign;  ///< also where a ghost stands for itself
};
StandIns find_stand_ins(const Sector& sector, const TracedTile& tile);

}  // namespace meshhier::progressive
