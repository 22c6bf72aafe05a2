// Sums up the claims that two neighbouring nodes of a level make of each other.
//
// Problem. Neighbours agree if both list the same border triangles between them, with the same
// normals if these are computed, and if each has the other's places there as they are: number,
// chain, position, attributes and, if neither has texture coordinates, normal of the first vertex
// (copy_claims.h sees to the others). To look into every neighbour's tile would be quadratic where
// all tiles are neighbours (a soup of long triangles).
//
// Idea. Each node sums up its claims of every pair it is in, and the two sums of a pair meet in one
// sort. Only pairs that differ need to be looked into:
//
//      node 3 says of (3, 7):   12 triangles' sum, its vertices' sum, 7's vertices' sum
//      node 7 says of (3, 7):   the same three sums                     equal: they agree
//
// Invariant. The sums are of 64-bit hashes (export/vertex_hash.h), so their order does not matter.
//
// Cost. Every tile is read once, whatever the mesh; one sort of two records a pair.
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

/// Returns whether the tile of a node that is not early has texture coordinates. In such a tile it
/// is its own matter which normal of a vertex is its first, and which are splits.
using HasTexcoords = std::function<bool(NodeId)>;

/// Two nodes of a level; low < high.
struct NodePair {
  std::uint32_t level = 0, low = 0, high = 0;
  friend constexpr auto operator<=>(const NodePair&, const NodePair&) = default;
};

/// The claims of one of the two.
struct PairSide {
  NodePair pair;
  std::uint32_t by_high = 0;        ///< 1: the claims are `high`'s, 0: `low`'s
  std::uint64_t triangles = 0;      ///< sum of border triangles that touch both
  std::uint64_t low_vertices = 0;   ///< sum of vertices of `low` in them
  std::uint64_t high_vertices = 0;  ///< sum of vertices of `high` in them
};

/// Gathers the sides of all pairs and compares them. For one thread.
class BorderPairs {
 public:
  /// `maps` must outlive it. `memory_bytes`: those of the sort.
  BorderPairs(const Tree& tree, ParentMaps& maps, HasTexcoords has_texcoords,
              storage::ScratchFile& scratch, std::uint64_t memory_bytes)
      : tree_(tree),
        maps_(maps),
        has_texcoords_(std::move(has_texcoords)),
        sides_(scratch, memory_bytes) {}

  /// Adds the claims of a tile; for a partition also those of the early node above it, if there is
  /// one. O(b log b), b its border triangles.
  void add(const PublishedTile& tile);

  /// Visits the pairs whose sides are not equal, or where one is missing, ascending. Called once,
  /// after all tiles.
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
