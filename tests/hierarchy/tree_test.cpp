#include "hierarchy/tree.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

constexpr std::uint64_t kMostVertices = 0xffffffff;

/// The definitions taken literally: levels of partition ranges, split from the root.
std::vector<std::vector<PartitionRange>> split_levels(std::uint32_t partition_count) {
  std::vector<std::vector<PartitionRange>> levels{{{0, partition_count}}};
  const auto too_large = [](const PartitionRange& range) { return range.size() > 1; };
  while (std::any_of(levels.back().begin(), levels.back().end(), too_large)) {
    std::vector<PartitionRange> next;
    for (const PartitionRange& range : levels.back()) {
      if (range.size() == 1) {  // early: stands for itself on the last level
        next.push_back(range);
        continue;
      }
      const std::uint32_t middle = range.begin + (range.size() + 1) / 2;
      next.push_back({range.begin, middle});
      next.push_back({middle, range.end});
    }
    levels.push_back(next);
  }
  return levels;
}

std::vector<std::uint32_t> interesting_partition_counts() {
  std::vector<std::uint32_t> counts;
  for (std::uint32_t p = 1; p <= 66; ++p)
    counts.push_back(p);
  for (const std::uint32_t p : {100U, 127U, 128U, 129U, 255U, 257U, 1000U})
    counts.push_back(p);
  return counts;
}

std::vector<std::uint64_t> interesting_vertex_counts(std::uint64_t p) {
  return {p, p + 1, 2 * p - 1, 2 * p, 3 * p + p / 2, 7919 + p, 437645, kMostVertices};
}

NodeId node_at(std::size_t level, std::size_t index) {
  return {static_cast<Level>(level), static_cast<std::uint32_t>(index)};
}

TEST(Tree, LevelsAndRangesAreThoseOfTheSplitRule) {
  for (const std::uint32_t p : interesting_partition_counts()) {
    const auto levels = split_levels(p);
    const Tree tree(kMostVertices, p);
    ASSERT_EQ(raw(tree.depth()) + 1U, levels.size()) << p;
    EXPECT_EQ(tree.partition_count(), p);
    for (std::size_t l = 0; l < levels.size(); ++l) {
      ASSERT_EQ(tree.node_count(static_cast<Level>(l)), levels[l].size()) << p << " " << l;
      for (std::size_t i = 0; i < levels[l].size(); ++i) {
        EXPECT_EQ(tree.partitions(node_at(l, i)), levels[l][i]) << p << " " << l << " " << i;
        EXPECT_EQ(tree.is_partition(node_at(l, i)), l + 1 == levels.size());
        EXPECT_EQ(tree.is_early(node_at(l, i)), l + 1 < levels.size() && levels[l][i].size() == 1);
      }
    }
  }
}

TEST(Tree, EarlyNodesAreOnlyOneLevelAboveTheLast) {
  for (const std::uint32_t p : interesting_partition_counts()) {
    const auto levels = split_levels(p);
    for (std::size_t l = 0; l + 2 < levels.size(); ++l) {
      EXPECT_EQ(levels[l].size(), std::size_t{1} << l);
      for (const PartitionRange& range : levels[l])
        EXPECT_GE(range.size(), 2U);
    }
  }
}

TEST(Tree, PartitionSizesDifferByOneAtMostAndFollowTheFormula) {
  for (const std::uint32_t p : interesting_partition_counts()) {
    for (const std::uint64_t n : interesting_vertex_counts(p)) {
      const Tree tree(n, p);
      std::uint64_t end = 0;
      for (std::uint32_t i = 0; i < p; ++i) {
        const RankRange ranks = tree.ranks(node_at(raw(tree.depth()), i));
        EXPECT_EQ(ranks.begin, i * n / p);
        EXPECT_EQ(ranks.begin, end);
        EXPECT_GE(ranks.size(), n / p);
        EXPECT_LE(ranks.size(), (n + p - 1) / p);
        end = ranks.end;
      }
      EXPECT_EQ(end, n);
      EXPECT_EQ(tree.ranks(tree.root()), (RankRange{0, n}));
    }
  }
}

TEST(Tree, EveryRankIsInThePartitionFoundForIt) {
  for (const std::uint32_t p : interesting_partition_counts()) {
    for (const std::uint64_t n : interesting_vertex_counts(p)) {
      const Tree tree(n, p);
      for (std::uint32_t i = 0; i < p; ++i) {
        const RankRange ranks = tree.ranks(node_at(raw(tree.depth()), i));
        const auto partition = static_cast<PartitionId>(i);
        const std::uint64_t step = std::max<std::uint64_t>(1, ranks.size() / 5);
        for (std::uint64_t r = ranks.begin; r < ranks.end; r += step)
          ASSERT_EQ(tree.partition_of(r), partition) << n << " " << p;
        ASSERT_EQ(tree.partition_of(ranks.end - 1), partition) << n << " " << p;
      }
    }
  }
}

TEST(Tree, AncestorsHoldWhatTheyAreAncestorsOf) {
  for (const std::uint32_t p : interesting_partition_counts()) {
    const auto levels = split_levels(p);
    const Tree tree(kMostVertices, p);
    for (std::size_t l = 0; l < levels.size(); ++l) {
      for (std::size_t i = 0; i < levels[l].size(); ++i) {
        for (std::size_t above = 0; above <= l; ++above) {
          const NodeId ancestor = tree.ancestor(node_at(l, i), static_cast<Level>(above));
          ASSERT_EQ(raw(ancestor.level), above);
          const PartitionRange outer = levels[above][ancestor.index];
          ASSERT_LE(outer.begin, levels[l][i].begin) << p << " " << l << " " << i << " " << above;
          ASSERT_GE(outer.end, levels[l][i].end) << p << " " << l << " " << i << " " << above;
        }
        if (l > 0) {
          const NodeId node = node_at(l, i);
          EXPECT_EQ(tree.parent(node), tree.ancestor(node, static_cast<Level>(l - 1)));
        }
      }
    }
  }
}

TEST(Tree, ChildrenAndParentsAgreeAndChildrenFillTheirParent) {
  for (const std::uint32_t p : interesting_partition_counts()) {
    const Tree tree(kMostVertices, p);
    for (std::size_t l = 0; l <= raw(tree.depth()); ++l) {
      std::uint32_t next = 0;  // nodes of the level below are met in order
      for (std::size_t i = 0; i < tree.node_count(static_cast<Level>(l)); ++i) {
        const NodeId node = node_at(l, i);
        const Tree::Children children = tree.children(node);
        ASSERT_EQ(children.count, tree.is_partition(node) ? 0 : tree.is_early(node) ? 1 : 2);
        std::uint32_t at = tree.partitions(node).begin;
        for (const NodeId child : children.span()) {
          EXPECT_EQ(child, node_at(l + 1, next++));
          EXPECT_EQ(tree.parent(child), node);
          EXPECT_EQ(tree.partitions(child).begin, at);
          at = tree.partitions(child).end;
        }
        if (children.count > 0) {
          EXPECT_EQ(at, tree.partitions(node).end);
        }
      }
    }
  }
}

TEST(Tree, CommonLevelIsTheDeepestSharedAncestor) {
  for (const std::uint32_t p : {1U, 2U, 3U, 5U, 6U, 8U, 13U, 31U, 33U}) {
    const Tree tree(kMostVertices, p);
    for (std::size_t l = 0; l <= raw(tree.depth()); ++l) {
      const std::uint32_t count = tree.node_count(static_cast<Level>(l));
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) {
          const NodeId a = node_at(l, i), b = node_at(l, j);
          std::size_t common = l;
          while (tree.ancestor(a, static_cast<Level>(common)) !=
                 tree.ancestor(b, static_cast<Level>(common))) {
            --common;
          }
          ASSERT_EQ(raw(tree.common_level(a, b)), common) << p << " " << l << " " << i << " " << j;
          if (i != j) {
            EXPECT_EQ(tree.chain_length(a, b), static_cast<int>(l - common));
          }
        }
      }
    }
  }
}

TEST(Tree, ContainsExactlyItsNodes) {
  const Tree tree(1000, 5);
  EXPECT_TRUE(tree.contains({Level{0}, 0}));
  EXPECT_FALSE(tree.contains({Level{0}, 1}));
  EXPECT_TRUE(tree.contains({Level{2}, 3}));
  EXPECT_FALSE(tree.contains({Level{2}, 4}));
  EXPECT_TRUE(tree.contains({Level{3}, 4}));
  EXPECT_FALSE(tree.contains({Level{3}, 5}));
  EXPECT_FALSE(tree.contains({Level{4}, 0}));
  EXPECT_FALSE(tree.contains({Level{255}, 0}));
}

TEST(Tree, OfOnePartitionIsItsRoot) {
  const Tree tree(10, 1);
  EXPECT_EQ(raw(tree.depth()), 0);
  EXPECT_TRUE(tree.is_partition(tree.root()));
  EXPECT_FALSE(tree.is_early(tree.root()));
  EXPECT_EQ(tree.children(tree.root()).count, 0);
  EXPECT_EQ(tree.ranks(tree.root()), (RankRange{0, 10}));
  EXPECT_EQ(tree.partition_of(9), PartitionId{0});
}

TEST(Tree, TilesStandForEveryNode) {
  for (const std::uint32_t p : {1U, 2U, 3U, 5U, 6U, 8U, 13U, 1000U}) {
    const Tree tree(5000, p);
    const std::vector<NodeId> tiles = tree.tile_nodes();
    EXPECT_TRUE(std::is_sorted(tiles.begin(), tiles.end())) << p;
    EXPECT_EQ(tiles.size(), tree.tile_count()) << p;
    std::size_t standing = 0;  // for their parents too
    for (const NodeId tile : tiles) {
      ASSERT_FALSE(tree.is_early(tile)) << p;
      ASSERT_EQ(tree.tile_node(tile), tile) << p;
      if (tile == tree.root())
        continue;
      const NodeId parent = tree.parent(tile);
      ASSERT_EQ(tree.stands_for_parent(tile), tree.tile_node(parent) == tile) << p;
      ASSERT_EQ(tree.parent_tile(tile), tree.stands_for_parent(tile) ? tree.parent(parent) : parent)
          << p;
      standing += tree.stands_for_parent(tile) ? 1 : 0;
    }
    std::size_t nodes = 0;
    for (int level = 0; level <= raw(tree.depth()); ++level)
      nodes += tree.node_count(static_cast<Level>(level));
    EXPECT_EQ(nodes, tiles.size() + standing) << p;
  }
}

TEST(Tree, ArithmeticHoldsAtTheLargestCounts) {
  constexpr auto kMost = static_cast<std::uint32_t>(kMostVertices);
  const Tree tree(kMostVertices, kMost);  // a partition for every vertex
  EXPECT_EQ(raw(tree.depth()), 32);
  EXPECT_EQ(tree.node_count(Level{31}), 1U << 31);
  for (const std::uint32_t p : {0U, 1U, (1U << 31) - 1, 1U << 31, kMost - 1}) {
    const NodeId leaf{tree.depth(), p};
    EXPECT_EQ(tree.ranks(leaf), (RankRange{p, std::uint64_t{p} + 1}));
    EXPECT_EQ(tree.partition_of(p), static_cast<PartitionId>(p));
    for (int level = 0; level <= 32; ++level) {
      const PartitionRange range = tree.partitions(tree.ancestor(leaf, static_cast<Level>(level)));
      EXPECT_LE(range.begin, p);
      EXPECT_GT(range.end, p);
    }
  }
  EXPECT_EQ(tree.common_level({tree.depth(), 0}, {tree.depth(), kMost - 1}), Level{0});
  EXPECT_TRUE(tree.is_early({Level{31}, (1U << 31) - 1}));
}

}  // namespace
}  // namespace meshhier::tests
