#include "hierarchy/cut.h"

#include "base/error.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace meshhier {
namespace {

std::string describe(PartitionRange range) {
  if (range.size() == 1)
    return "partition " + std::to_string(range.begin);
  return "partitions " + std::to_string(range.begin) + " to " + std::to_string(range.end - 1);
}

std::string levels_text(const Tree& tree) {
  return ": the levels are 0 to " + std::to_string(raw(tree.depth()));
}

/// The nodes cover [0, end of the range before), then `next`.
void require_adjacent(NodeId before, std::uint32_t covered, NodeId next, PartitionRange range) {
  if (range.begin > covered) {
    throw Error(ErrorCode::usage,
                "not a cut: no node covers " + describe(PartitionRange{covered, range.begin}));
  }
  if (range.begin < covered) {
    throw Error(ErrorCode::usage, "not a cut: nodes " + to_text(before) + " and " + to_text(next) +
                                      " both cover partition " + std::to_string(range.begin));
  }
}

}  // namespace

std::string to_text(NodeId node) {
  return std::to_string(raw(node.level)) + '/' + std::to_string(node.index);
}

void require_level(const Tree& tree, Level level) {
  if (level <= tree.depth())
    return;
  throw Error(ErrorCode::usage,
              "there is no level " + std::to_string(raw(level)) + levels_text(tree));
}

void require_node(const Tree& tree, NodeId node) {
  if (tree.contains(node))
    return;
  if (node.level > tree.depth()) {
    throw Error(ErrorCode::usage, "there is no node " + to_text(node) + levels_text(tree));
  }
  throw Error(ErrorCode::usage, "there is no node " + to_text(node) + ": the nodes of level " +
                                    std::to_string(raw(node.level)) + " are 0 to " +
                                    std::to_string(tree.node_count(node.level) - 1));
}

Cut::Cut(const Tree& tree, std::vector<NodeId> nodes) : nodes_(std::move(nodes)) {
  for (NodeId& node : nodes_) {
    require_node(tree, node);
    node = tree.tile_node(node);
  }
  const auto first = [&](NodeId node) { return tree.partitions(node).begin; };
  std::sort(nodes_.begin(), nodes_.end(),
            [&](NodeId a, NodeId b) { return std::pair(first(a), a) < std::pair(first(b), b); });
  std::uint32_t covered = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const PartitionRange range = tree.partitions(nodes_[i]);
    require_adjacent(nodes_[i == 0 ? 0 : i - 1], covered, nodes_[i], range);
    first_partitions_.push_back(range.begin);
    covered = range.end;
  }
  if (covered < tree.partition_count()) {
    throw Error(ErrorCode::usage, "not a cut: no node covers " +
                                      describe(PartitionRange{covered, tree.partition_count()}));
  }
}

Cut Cut::of_level(const Tree& tree, Level level) {
  assert(level <= tree.depth());
  std::vector<NodeId> nodes(tree.node_count(level));
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    nodes[i] = {level, i};
  return {tree, std::move(nodes)};
}

std::size_t Cut::position_of(PartitionId partition) const {
  const auto after =
      std::upper_bound(first_partitions_.begin(), first_partitions_.end(), raw(partition));
  return static_cast<std::size_t>(after - first_partitions_.begin()) - 1;
}

}  // namespace meshhier
