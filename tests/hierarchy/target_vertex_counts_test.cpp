#include "hierarchy/target_vertex_counts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier {
namespace {

using testing::ElementsAre;

TEST(TargetVertexCountsTest, OneNumberHoldsForAllLevels) {
  const TargetVertexCounts asked = 300;
  EXPECT_EQ(asked.of(Level{0}), 300U);
  EXPECT_EQ(asked.of(Level{255}), 300U);
  EXPECT_EQ(asked.largest_above(Level{1}), 300U);
  EXPECT_EQ(asked.largest_above(Level{9}), 300U);
  EXPECT_THAT(asked.by_level(), ElementsAre(300U));
}

TEST(TargetVertexCountsTest, TheLastOfAListHoldsForAllDeeperLevels) {
  const TargetVertexCounts asked({30, 10, 20});
  EXPECT_EQ(asked.of(Level{0}), 30U);
  EXPECT_EQ(asked.of(Level{1}), 10U);
  EXPECT_EQ(asked.of(Level{2}), 20U);
  EXPECT_EQ(asked.of(Level{3}), 20U);
  EXPECT_EQ(asked.of(Level{31}), 20U);
}

TEST(TargetVertexCountsTest, TheLargestIsOfTheLevelsThatAreThere) {
  const TargetVertexCounts asked({10, 30, 20, 40});
  EXPECT_EQ(asked.largest_above(Level{0}), 0U);
  EXPECT_EQ(asked.largest_above(Level{1}), 10U);
  EXPECT_EQ(asked.largest_above(Level{3}), 30U);
  EXPECT_EQ(asked.largest_above(Level{4}), 40U);
  EXPECT_EQ(asked.largest_above(Level{30}), 40U);
}

TEST(TargetVertexCountsTest, AListOfOneIsTheNumber) {
  EXPECT_EQ(TargetVertexCounts({7}), TargetVertexCounts(7));
  EXPECT_NE(TargetVertexCounts({7, 8}), TargetVertexCounts(7));
}

TEST(TargetVertexCountsTest, TheTargetIsWhatWasAskedWhereThereAreEnoughVertices) {
  EXPECT_EQ(TargetVertexCounts(8192).target(Level{3}, 16384), 8192U);
  EXPECT_EQ(TargetVertexCounts(32768).target(Level{3}, 65536), 32768U);
  EXPECT_EQ(TargetVertexCounts(6).target(Level{3}, 8), 6U);
}

TEST(TargetVertexCountsTest, TheTargetIsAlwaysCoarserThanBelow) {
  EXPECT_EQ(TargetVertexCounts(50).target(Level{3}, 40), 30U);
  EXPECT_EQ(TargetVertexCounts(50).target(Level{3}, 50), 37U);
  for (std::uint32_t count = 2; count < 100; ++count) {
    for (const std::uint32_t asked : {4U, 5U, 50U, 32768U})
      EXPECT_LT(TargetVertexCounts(asked).target(Level{3}, count), count);
  }
}

TEST(TargetVertexCountsTest, TheTargetIsAtLeastOne) {
  EXPECT_EQ(TargetVertexCounts(4).target(Level{3}, 1), 1U);
  EXPECT_EQ(TargetVertexCounts(4).target(Level{3}, 2), 1U);
}

TEST(TargetVertexCountsTest, LevelsOfAListAreCoarserByASixteenthAtLeast) {
  const TargetVertexCounts asked({937, 573, 4});
  EXPECT_EQ(asked.target(Level{0}, 2 * 573), 937U);
  EXPECT_EQ(asked.target(Level{0}, 960), 900U);
  for (std::uint32_t count = 2; count < 2000; ++count) {
    EXPECT_LT(asked.target(Level{0}, count), count);
    EXPECT_LT(asked.target(Level{5}, count), count);
  }
  EXPECT_EQ(asked.target(Level{5}, 1), 1U);
}

}  // namespace
}  // namespace meshhier
