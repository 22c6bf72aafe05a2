// The kd-tree's shape, by arithmetic alone: it follows from the vertex and partition counts.
//
// A rank is a vertex's position in kd order, 0 to N - 1; a plain number, since mostly runs of ranks
// are asked for. Partition p of P holds the ranks from floor(p N / P) to floor((p + 1) N / P) - 1:
// sizes equal +-1.
// A node holds a run of partitions [p0, p1), split at p0 + ceil((p1 - p0) / 2); level 0 is the
// root. Levels 0 .. depth-1 have exactly 2^level nodes. The last level, depth, has the P
// partitions, one node each. A node of level depth-1 that holds a single partition is *early*: it
// has no tile of its own, its partition stands for it.
#pragma once

#include "hierarchy/ids.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier {

/// Partitions [begin, end).
struct PartitionRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  constexpr std::uint32_t size() const { return end - begin; }
  friend constexpr bool operator==(const PartitionRange&, const PartitionRange&) = default;
};

/// Ranks [begin, end).
struct RankRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  constexpr std::uint64_t size() const { return end - begin; }
  friend constexpr bool operator==(const RankRange&, const RankRange&) = default;
};

class Tree {
 public:
  /// Requires 1 <= partition_count <= vertex_count < 2^32.
  Tree(std::uint64_t vertex_count, std::uint32_t partition_count);

  std::uint64_t vertex_count() const { return vertex_count_; }
  std::uint32_t partition_count() const { return partition_count_; }

  /// The last level: ceil(log2 P).
  Level depth() const { return depth_; }
  NodeId root() const { return {}; }
  bool is_partition(NodeId node) const { return node.level == depth_; }

  /// Nodes of a level: 2^level, P on the last.
  std::uint32_t node_count(Level level) const;
  bool contains(NodeId node) const {
    return node.level <= depth_ && node.index < node_count(node.level);
  }

  PartitionRange partitions(NodeId node) const;
  RankRange ranks(PartitionRange partitions) const;
  RankRange ranks(NodeId node) const { return ranks(partitions(node)); }
  /// The partition that holds a rank, in [0, N).
  PartitionId partition_of(std::uint64_t rank) const;

  /// True for a node of level depth-1 that holds a single partition and so has no tile of its own.
  bool is_early(NodeId node) const;

  /// The node whose tile stands for `node`: itself, or the partition of an early node.
  NodeId tile_node(NodeId node) const { return is_early(node) ? children(node).nodes[0] : node; }
  /// Whether the node's tile stands for its parent too: a partition below an early node. O(log P).
  bool stands_for_parent(NodeId node) const {
    return is_partition(node) && raw(node.level) > 0 && is_early(parent(node));
  }
  /// The nearest node above `node` that has a tile. Requires node.level > 0.
  NodeId parent_tile(NodeId node) const {
    const NodeId above = parent(node);
    return is_early(above) ? parent(above) : above;
  }
  /// How many nodes have a tile: all but the early ones. Every tile above the partitions replaces
  /// two by one: a binary tree with P leaves.
  std::uint64_t tile_count() const { return 2 * std::uint64_t{partition_count_} - 1; }
  /// These nodes, ascending. O(P log P).
  std::vector<NodeId> tile_nodes() const;

  /// One level up / the node of `level` that holds `node`. Require node.level > 0 / level <=
  /// node.level.
  NodeId parent(NodeId node) const { return ancestor(node, coarser(node.level)); }
  NodeId ancestor(NodeId node, Level level) const;

  struct Children {
    std::array<NodeId, 2> nodes{};
    int count = 0;
    std::span<const NodeId> span() const& {
      return {nodes.data(), static_cast<std::size_t>(count)};
    }
    void span() const&& = delete;  ///< it would outlive its array
  };
  /// The one (early) or two nodes below; none for a partition.
  Children children(NodeId node) const;

  /// Level of the deepest node that holds both. Requires a.level == b.level.
  Level common_level(NodeId a, NodeId b) const;

  /// How many levels a ghost reference from `tile` to `neighbour` spans: its own level and those
  /// above it, down from the level just below the common ancestor. Requires equal levels, a != b.
  int chain_length(NodeId tile, NodeId neighbour) const {
    return raw(tile.level) - raw(common_level(tile, neighbour));
  }

 private:
  std::uint64_t first_rank(std::uint32_t partition) const;

  std::uint64_t vertex_count_;
  std::uint32_t partition_count_;
  Level depth_;
};

}  // namespace meshhier
