#include "pipeline/tiles/bound_chain.h"

#include "storage/io/blob_store.h"
#include "storage/io/file.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using tests::node;

constexpr double kDiagonal = 1000;

/// Facts of tiles without tiles.
class BoundChainTest : public testing::Test {
 protected:
  void make(std::uint32_t partitions, double diagonal = kDiagonal) {
    tree_ = Tree(partitions * 10, partitions);
    chain_ = std::make_unique<BoundChain>(tree_, diagonal);
  }
  float bound(int level, std::uint32_t index) const {
    return chain_->errors()[node(level, index)].bound;
  }
  float error(int level, std::uint32_t index) const {
    return chain_->errors()[node(level, index)].error;
  }
  void add(int level, const std::vector<StepDeviation>& steps) {
    chain_->add(static_cast<Level>(level), steps);
  }

  Tree tree_{1, 1};
  std::unique_ptr<BoundChain> chain_;
};

TEST(TileSetTest, SortsAndDropsRepeats) {
  TileSet tiles;
  for (const std::uint32_t tile : {3U, 1U, 3U, 2U, 1U})
    tiles.add(tile);
  tiles.settle();
  EXPECT_THAT(tiles.numbers(), ElementsAre(1U, 2U, 3U));
  EXPECT_FALSE(tiles.is_all());
  TileSet none;
  none.settle();
  EXPECT_THAT(none.numbers(), IsEmpty());
}

TEST(TileSetTest, MoreThanAFewAreAll) {
  TileSet tiles;
  for (int round = 0; round < 9; ++round) {
    for (std::uint32_t tile = 0; tile < TileSet::kMost; ++tile)
      tiles.add(tile);
  }
  tiles.settle();
  EXPECT_FALSE(tiles.is_all());
  EXPECT_EQ(tiles.numbers().size(), TileSet::kMost);
  tiles.add(TileSet::kMost);
  tiles.settle();
  EXPECT_TRUE(tiles.is_all());
  EXPECT_TRUE(TileSet(tiles.numbers()).is_all());
  tiles.add(5);
  EXPECT_TRUE(tiles.is_all());
}

TEST_F(BoundChainTest, StepsAddUpLevelByLevel) {
  make(4);
  add(1, {{1, 0.25, {}}, {2, 0.25, {}}});
  add(0, {{4, 1, {}}});
  EXPECT_FLOAT_EQ(bound(1, 0), 1);
  EXPECT_FLOAT_EQ(bound(1, 1), 2);
  EXPECT_FLOAT_EQ(bound(0, 0), 6);
  EXPECT_FLOAT_EQ(error(1, 0), 0.5F);
  EXPECT_FLOAT_EQ(error(0, 0), 1.5F);
  for (std::uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(bound(2, i), 0);
}

TEST_F(BoundChainTest, NothingIsFartherOffThanTheModelIsLarge) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  make(4);
  add(1, {{kInfinity, kInfinity, {}}, {2, 0.25, {}}});
  add(0, {{4, 1, {}}});
  for (const float value : {error(1, 0), bound(1, 0), error(0, 0), bound(0, 0)})
    EXPECT_FLOAT_EQ(value, kDiagonal);
  EXPECT_GT(error(0, 0), error(1, 0));
  EXPECT_FLOAT_EQ(error(1, 1), 0.5F);
}

TEST_F(BoundChainTest, WhatATileWasHeldAgainstCountsOnTheWayBack) {
  // Level 1's tile 1 is measured against tile 3's partition, too; that adds nothing. Level 0's
  // second step below is held against its neighbour's tile of the finer level.
  make(8);
  add(2, {{1, 0, {}}, {1, 0, {}}, {7, 0, {}}, {1, 0, {}}});
  add(1, {{2, 0, {{2}}}, {3, 0, {}}});
  EXPECT_FLOAT_EQ(bound(1, 0), 2 + 7);  // back through tile 2 of level 2
  EXPECT_FLOAT_EQ(bound(1, 1), 3 + 7);
}

TEST_F(BoundChainTest, PointsThatMayLieInANeighbourTakeItsStep) {
  make(8);
  // Tile 0 of level 2 draws what was tile 2's partition (4): from under tile 0 a point may have
  // come to lie in what partition 4 belongs to.
  add(2, {{1, 0, {{4}}}, {1, 0, {}}, {5, 0, {}}, {1, 0, {}}});
  EXPECT_FLOAT_EQ(bound(2, 0), 1);  // nodes that lay in it took their own step
  EXPECT_FLOAT_EQ(bound(2, 1), 1);
  // It may have ended in tile 2, whose parent is tile 1: that one takes the next.
  add(1, {{1, 0, {}}, {9, 0, {}}});
  EXPECT_FLOAT_EQ(bound(1, 0), 1 + 9);
  EXPECT_FLOAT_EQ(bound(1, 1), 5 + 9);
}

TEST_F(BoundChainTest, NothingIsFartherThanTheWholeModel) {
  make(4, 10);
  add(1, {{std::numeric_limits<double>::infinity(), 0, {}}, {6, 0, {}}});
  add(0, {{6, 0, {}}});
  EXPECT_EQ(bound(1, 0), 10);
  EXPECT_FLOAT_EQ(bound(1, 1), 6);
  EXPECT_GE(bound(0, 0), 10);
  EXPECT_LE(bound(0, 0), std::nextafter(10.0F, 11.0F));
}

TEST_F(BoundChainTest, ParentsAreAboveTheirChildrenEvenWhereNothingMoves) {
  make(4);
  add(1, {{0, 0, {}}, {0, 0, {}}});
  add(0, {{0, 0, {}}});
  EXPECT_GT(error(1, 0), 0);
  EXPECT_GT(error(0, 0), error(1, 0));
  EXPECT_GT(bound(1, 0), 0);
  EXPECT_GT(bound(0, 0), bound(1, 0));
  EXPECT_LT(bound(0, 0), 1e-40F);
}

TEST_F(BoundChainTest, BoundsAreNotBelowErrors) {
  make(2);
  add(0, {{1, 9, {}}});
  EXPECT_EQ(error(0, 0), 3);
  EXPECT_GE(bound(0, 0), 3);
}

TEST_F(BoundChainTest, EarlyNodesAreTheirPartitions) {
  make(5);  // three of four nodes on level 2 hold one partition
  ASSERT_EQ(raw(tree_.depth()), 3);
  std::vector<StepDeviation> steps(4);
  std::uint32_t early = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (!tree_.is_early(node(2, i)))
      steps[i].certain = 2;
    else
      ++early;
  }
  ASSERT_EQ(early, 3U);
  add(2, steps);
  for (std::uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(bound(2, i), tree_.is_early(node(2, i)) ? 0 : 2);
}

TEST_F(BoundChainTest, SumsAreNeverRoundedDown) {
  make(2);
  const double certain = 1 + 0x1p-40;
  add(0, {{certain, 0, {}}});
  EXPECT_GE(double{bound(0, 0)}, certain);
}

}  // namespace
}  // namespace meshhier::pipeline
