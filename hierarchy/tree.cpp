#include "hierarchy/tree.h"

#include <bit>
#include <cassert>

namespace meshhier {
namespace {

constexpr std::uint32_t split_at(PartitionRange range) {
  return range.begin + range.size() / 2 + range.size() % 2;  // ceil without overflow
}

}  // namespace

Tree::Tree(std::uint64_t vertex_count, std::uint32_t partition_count)
    : vertex_count_(vertex_count),
      partition_count_(partition_count),
      depth_(static_cast<Level>(std::bit_width(partition_count - 1U))) {
  assert(partition_count >= 1 && partition_count <= vertex_count);
  assert(vertex_count < (std::uint64_t{1} << 32));
}

std::uint32_t Tree::node_count(Level level) const {
  return level == depth_ ? partition_count_ : std::uint32_t{1} << raw(level);
}

PartitionRange Tree::partitions(NodeId node) const {
  assert(contains(node));
  if (is_partition(node))
    return {node.index, node.index + 1};
  PartitionRange range{0, partition_count_};
  for (int bit = raw(node.level) - 1; bit >= 0; --bit) {
    const std::uint32_t middle = split_at(range);
    if ((node.index >> bit & 1U) != 0) {
      range.begin = middle;
    } else {
      range.end = middle;
    }
  }
  return range;
}

std::uint64_t Tree::first_rank(std::uint32_t partition) const {
  return partition * vertex_count_ / partition_count_;  // < 2^64: both factors < 2^32
}

RankRange Tree::ranks(PartitionRange partitions) const {
  return {first_rank(partitions.begin), first_rank(partitions.end)};
}

PartitionId Tree::partition_of(std::uint64_t rank) const {
  // The largest p with floor(p N / P) <= rank, that is p N < (rank + 1) P.
  const std::uint64_t bound = (rank + 1) * partition_count_;
  return static_cast<PartitionId>((bound - 1) / vertex_count_);
}

bool Tree::is_early(NodeId node) const {
  return !is_partition(node) && finer(node.level) == depth_ && partitions(node).size() == 1;
}

std::vector<NodeId> Tree::tile_nodes() const {
  std::vector<NodeId> nodes;
  nodes.reserve(tile_count());
  for (int level = 0; level <= raw(depth_); ++level) {
    NodeId node{static_cast<Level>(level), 0};
    for (const std::uint32_t count = node_count(node.level); node.index < count; ++node.index) {
      if (!is_early(node))
        nodes.push_back(node);
    }
  }
  return nodes;
}

NodeId Tree::ancestor(NodeId node, Level level) const {
  assert(level <= node.level);
  if (level == node.level)
    return node;
  if (!is_partition(node))
    return {level, node.index >> (raw(node.level) - raw(level))};
  PartitionRange range{0, partition_count_};
  std::uint32_t index = 0;
  for (int depth = 0; depth < raw(level); ++depth) {
    const std::uint32_t middle = split_at(range);
    const bool right = node.index >= middle;
    (right ? range.begin : range.end) = middle;
    index = 2 * index + (right ? 1 : 0);
  }
  return {level, index};
}

Tree::Children Tree::children(NodeId node) const {
  if (is_partition(node))
    return {};
  const Level below = finer(node.level);
  if (below != depth_)
    return {{NodeId{below, 2 * node.index}, NodeId{below, 2 * node.index + 1}}, 2};
  const PartitionRange range = partitions(node);
  return {{NodeId{below, range.begin}, NodeId{below, range.begin + 1}},
          static_cast<int>(range.size())};
}

Level Tree::common_level(NodeId a, NodeId b) const {
  assert(a.level == b.level);
  if (a == b)
    return a.level;
  if (is_partition(a)) {
    a = parent(a);
    b = parent(b);
  }
  return static_cast<Level>(raw(a.level) - std::bit_width(a.index ^ b.index));
}

}  // namespace meshhier
