#include "hierarchy/asked_vertices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier {
namespace {

using testing::ElementsAre;

TEST(AskedVerticesTest, OneNumberHoldsForAllLevels) {
  const AskedVertices asked = 300;
  EXPECT_EQ(asked.of(Level{0}), 300U);
  EXPECT_EQ(asked.of(Level{255}), 300U);
  EXPECT_EQ(asked.largest_above(Level{1}), 300U);
  EXPECT_EQ(asked.largest_above(Level{9}), 300U);
  EXPECT_THAT(asked.by_level(), ElementsAre(300U));
}

TEST(AskedVerticesTest, TheLastOfAListHoldsForAllDeeperLevels) {
  const AskedVertices asked({30, 10, 20});
  EXPECT_EQ(asked.of(Level{0}), 30U);
  EXPECT_EQ(asked.of(Level{1}), 10U);
  EXPECT_EQ(asked.of(Level{2}), 20U);
  EXPECT_EQ(asked.of(Level{3}), 20U);
  EXPECT_EQ(asked.of(Level{31}), 20U);
}

TEST(AskedVerticesTest, TheLargestIsOfTheLevelsThatAreThere) {
  const AskedVertices asked({10, 30, 20, 40});
  EXPECT_EQ(asked.largest_above(Level{0}), 0U);
  EXPECT_EQ(asked.largest_above(Level{1}), 10U);
  EXPECT_EQ(asked.largest_above(Level{3}), 30U);
  EXPECT_EQ(asked.largest_above(Level{4}), 40U);
  EXPECT_EQ(asked.largest_above(Level{30}), 40U);
}

TEST(AskedVerticesTest, AListOfOneIsTheNumber) {
  EXPECT_EQ(AskedVertices({7}), AskedVertices(7));
  EXPECT_NE(AskedVertices({7, 8}), AskedVertices(7));
}

}  // namespace
}  // namespace meshhier
