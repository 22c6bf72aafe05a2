// What two neighbouring nodes of a level say of each other, summed up.
//
// Neighbours agree if both list the same border triangles between them, with the same normals if
// these are computed, and if each has the other's places there as they are: number, chain,
// position, attributes and, if neither has texture coordinates, normal of the first vertex
// (copy_claims.h sees to the others). To look
// into every neighbour's tile would be quadratic where all tiles are neighbours (a soup of long
// triangles). So each node sums up what it says of every pair it is in, and the two sums of a pair
// meet in one sort: every tile is read once, whatever the mesh. Only pairs that differ need to be
// looked into.
//
// The sums are of 64-bit hashes (vertex_hash.h), so their order does not matter.
#pragma once

#include "export/node_cache.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "partition/external_sort.h"
#include "verify/corner_triangle.h"

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace meshhier::verifying {

/// Parent maps by node that has a tile; empty ones where it cannot be read.
using ParentMaps = exporting::NodeCache<std::vector<std::uint16_t>>;

/// Whether the tile of a node that is not early has texture coordinates: which normal of a vertex
/// is its first, and which are splits, is such a tile's own matter.
using HasTexcoords = std::function<bool(NodeId)>;

/// Two nodes of a level; low < high.
struct NodePair {
  std::uint32_t level = 0, low = 0, high = 0;
  friend constexpr auto operator<=>(const NodePair&, const NodePair&) = default;
};

/// What one of the two says.
struct PairSide {
  NodePair pair;
  std::uint32_t by_high = 0;        ///< 1: `high` says it
  std::uint64_t triangles = 0;      ///< border triangles that touch both
  std::uint64_t low_vertices = 0;   ///< vertices of `low` in them
  std::uint64_t high_vertices = 0;  ///< vertices of `high` in them
};

/// Gathers the sides of all pairs and compares them.
class BorderPairs {
 public:
  /// `maps` must outlive it. `memory_bytes`: of the sort.
  BorderPairs(const Tree& tree, ParentMaps& maps, HasTexcoords has_texcoords,
              storage::ScratchFile& scratch, std::uint64_t memory_bytes)
      : tree_(tree),
        maps_(maps),
        has_texcoords_(std::move(has_texcoords)),
        sides_(scratch, memory_bytes) {}

  /// What a tile says; for a partition also what the early node above it says, if there is one.
  /// O(b log b), b its border triangles.
  void add(const PublishedTile& tile);

  /// Visits the pairs whose sides are not equal, or of which one is missing, ascending. Call it
  /// once, after all tiles.
  void finish(const std::function<void(const NodePair&)>& differ);

 private:
  struct SideKey {
    auto operator()(const PairSide& side) const { return std::tuple(side.pair, side.by_high); }
  };
  struct Sums {
    std::uint64_t triangles = 0, own = 0, other = 0;
  };
  using SumsByOther = std::map<std::uint32_t, Sums>;
  /// A vertex of this node in a triangle that touches another.
  struct Use {
    std::uint32_t other, vertex;
    friend constexpr auto operator<=>(const Use&, const Use&) = default;
  };
  class Node;

  void add_sides(const Node& node, std::span<const ShadedTriangle> border,
                 const PublishedTile* ghosts_of);
  std::vector<Use> add_triangles(NodeId node, std::span<const ShadedTriangle> border,
                                 SumsByOther& sums) const;
  void add_own(const Node& node, std::vector<Use> uses, SumsByOther& sums) const;
  void add_ghosts(const PublishedTile& tile, SumsByOther& sums) const;
  std::span<const NormalCode> common_normal(const PublishedTile& tile, std::size_t vertex,
                                            NodeId other) const;
  bool compare_attributes(NodeId a, NodeId b) const;
  bool agree(const PairSide& low, const PairSide& high) const;

  const Tree& tree_;
  ParentMaps& maps_;
  HasTexcoords has_texcoords_;
  partition::ExternalSort<PairSide, SideKey> sides_;
};

}  // namespace meshhier::verifying
