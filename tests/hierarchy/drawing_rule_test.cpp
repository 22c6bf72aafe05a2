#include "hierarchy/drawing_rule.h"

#include "hierarchy/cut.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

using tests::node;

constexpr std::uint32_t kPartitions = 6;  // 2, 1, 2, 1 below the four nodes of level 2

NodeId shown_at(const Cut& cut, std::uint32_t partition) {
  return cut[cut.position_of(PartitionId{partition})];
}

/// How many tiles of a cut draw a triangle with corners in some partitions.
int draw_count(const Tree& tree, const Cut& cut, const std::array<std::uint32_t, 3>& partitions) {
  std::vector<NodeId> touched;
  for (const std::uint32_t p : partitions)
    touched.push_back(shown_at(cut, p));
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return static_cast<int>(std::count_if(touched.begin(), touched.end(), [&](NodeId tile) {
    return std::all_of(partitions.begin(), partitions.end(), [&](std::uint32_t p) {
      const NodeId shown = shown_at(cut, p);
      if (shown == tile)
        return true;
      if (shown.level > tile.level)
        return draws_before(tile, tree.ancestor(shown, tile.level).index, shown.level);
      return draws_before(tile, tree.ancestor({tree.depth(), p}, tile.level).index, shown.level);
    });
  }));
}

TEST(DrawingRule, OneTileOfACutDrawsABorderTriangle) {
  const Tree tree(60, kPartitions);
  const std::vector<Cut> cuts = {
      Cut::of_level(tree, Level{1}),
      Cut::of_level(tree, Level{2}),
      Cut::of_level(tree, Level{3}),
      Cut(tree, {node(1, 0), node(2, 2), node(3, 5)}),
      Cut(tree, {node(2, 0), node(3, 2), node(1, 1)}),
      Cut(tree, {node(3, 0), node(3, 1), node(2, 1), node(2, 2), node(2, 3)})};
  for (const Cut& cut : cuts) {
    for (std::uint32_t a = 0; a < kPartitions; ++a) {
      for (std::uint32_t b = 0; b < kPartitions; ++b) {
        for (std::uint32_t c = 0; c < kPartitions; ++c)
          ASSERT_EQ(draw_count(tree, cut, {a, b, c}), 1) << a << " " << b << " " << c;
      }
    }
  }
}

TEST(DrawingRule, TheFinestThenTheLowestGoesFirst) {
  const NodeId tile = node(2, 2);
  EXPECT_TRUE(draws_before(tile, 0, Level{1})) << "shown coarser";
  EXPECT_TRUE(draws_before(tile, 3, Level{2}));
  EXPECT_FALSE(draws_before(tile, 1, Level{2}));
  EXPECT_FALSE(draws_before(tile, 3, Level{3})) << "shown finer";
}

TEST(DrawingRule, InTheCutOfALevelEarlyNeighboursAreFiner) {
  const Tree tree(60, kPartitions);
  EXPECT_TRUE(draws_before(tree, node(2, 0), 2));
  EXPECT_FALSE(draws_before(tree, node(2, 0), 1)) << "early";
  EXPECT_FALSE(draws_before(tree, node(2, 2), 0));
  EXPECT_TRUE(draws_before(tree, node(3, 1), 2)) << "an early node's partition is one of many";
}

TEST(DrawingRule, AllGhostsOfATriangleMustComeAfterTheTile) {
  const Tree tree(60, kPartitions);
  TileMesh mesh;
  mesh.own_count = 2;
  mesh.ghosts = {{0, 0}, {1, 0}, {3, 0}, {4, 0}};  // vertices 2, 3, 4, 5
  const auto triangle = [](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return TileTriangle{TileVertex{a}, TileVertex{b}, TileVertex{c}};
  };
  mesh.border = {triangle(0, 1, 4), triangle(0, 4, 5), triangle(0, 1, 2), triangle(0, 2, 4),
                 triangle(1, 5, 3)};
  EXPECT_EQ(drawn_border_count(tree, node(3, 2), mesh), 2U);
  EXPECT_EQ(drawn_border_count(tree, node(3, 5), mesh), 0U);
  std::vector<std::size_t> asked;
  EXPECT_TRUE(draws(mesh, triangle(4, 0, 5), [&](std::size_t ghost) {
    asked.push_back(ghost);
    return true;
  }));
  EXPECT_EQ(asked, (std::vector<std::size_t>{2, 3})) << "places in mesh.ghosts";
}

}  // namespace
}  // namespace meshhier
