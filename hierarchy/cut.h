// A cut of the tree: the nodes a viewer shows at one moment.
//
// Early nodes have no tile; a cut names the partition that stands for them instead, which counts as
// of the last level wherever levels are compared.
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/tree.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshhier {

/// "3/17": level and index.
std::string to_text(NodeId node);

/// Throws Error(usage), saying what there is, if the tree has no such level / node.
void require_level(const Tree& tree, Level level);
void require_node(const Tree& tree, NodeId node);

/// Nodes of which every partition has exactly one ancestor-or-self. Immutable.
class Cut {
 public:
  /// `nodes` in any order; early nodes are replaced with their partitions. Throws Error(usage)
  /// naming a node that the tree has not, the first partition that no node holds, or two nodes that
  /// overlap.
  Cut(const Tree& tree, std::vector<NodeId> nodes);

  /// All nodes of a level. Requires level <= tree.depth().
  static Cut of_level(const Tree& tree, Level level);

  /// From left to right; none is early.
  std::span<const NodeId> nodes() const { return nodes_; }
  std::size_t size() const { return nodes_.size(); }
  NodeId operator[](std::size_t position) const { return nodes_[position]; }

  /// The position in nodes() of the node that shows a partition. O(log size).
  std::size_t position_of(PartitionId partition) const;

 private:
  std::vector<NodeId> nodes_;
  std::vector<std::uint32_t> first_partitions_;  ///< of every node; ascending
};

}  // namespace meshhier
