#include "partition/spatial_order.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

using testing::ElementsAre;

std::vector<std::uint32_t> identity(std::size_t count) {
  std::vector<std::uint32_t> result(count);
  std::iota(result.begin(), result.end(), 0U);
  return result;
}

void expect_permutation(std::vector<std::uint32_t> order, std::size_t count) {
  std::ranges::sort(order);
  EXPECT_EQ(order, identity(count));
}

double mean_step(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& order) {
  double sum = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    sum += length(to_double(positions[order[i]]) - to_double(positions[order[i - 1]]));
  }
  return sum / static_cast<double>(order.size() - 1);
}

TEST(SpatialOrderTest, NamesEveryPointOnce) {
  for (const std::size_t count : {0U, 1U, 2U, 3U, 1000U, 70000U})
    expect_permutation(spatial_order(tests::points(count).positions), count);
}

TEST(SpatialOrderTest, NeighboursInNumberAreNeighboursInSpace) {
  const std::vector<Vec3f> positions = tests::points(20000).positions;  // 2 across, in any order
  EXPECT_GT(mean_step(positions, identity(positions.size())), 1);
  // About 27 points a side: 0.074 apart; a Morton curve jumps at times.
  EXPECT_LT(mean_step(positions, spatial_order(positions)), 3 * 0.074);
}

TEST(SpatialOrderTest, GoesThroughOneOctantAfterTheOther) {
  std::vector<Vec3f> positions;
  for (int i = 0; i < 8; ++i) {
    positions.push_back({i & 1 ? 1.0F : -1.0F, i & 2 ? 1.0F : -1.0F, i & 4 ? 1.0F : -1.0F});
  }
  EXPECT_EQ(spatial_order(positions), identity(8));
  std::ranges::reverse(positions);
  EXPECT_THAT(spatial_order(positions), ElementsAre(7U, 6U, 5U, 4U, 3U, 2U, 1U, 0U));
}

TEST(SpatialOrderTest, EqualPointsStayInOrder) {
  const std::vector<Vec3f> positions(100, Vec3f{1, 2, 3});
  EXPECT_EQ(spatial_order(positions), identity(100));
  std::vector<Vec3f> two;
  for (int i = 0; i < 10; ++i)
    two.push_back({i % 2 == 0 ? 5.0F : -5.0F, 0, 0});
  EXPECT_THAT(spatial_order(two), ElementsAre(1U, 3U, 5U, 7U, 9U, 0U, 2U, 4U, 6U, 8U));
}

TEST(SpatialOrderTest, PointsOnALineAscendAlongIt) {
  std::vector<Vec3f> positions;
  for (int i = 0; i < 500; ++i)
    positions.push_back({0, static_cast<float>((i * 7) % 500), 0});
  const std::vector<std::uint32_t> order = spatial_order(positions);
  for (std::size_t i = 1; i < order.size(); ++i)
    ASSERT_LT(positions[order[i - 1]].y, positions[order[i]].y);
}

TEST(SpatialOrderTest, TheEndsOfFloatAreServed) {
  using Limits = std::numeric_limits<float>;
  const float nan = Limits::quiet_NaN();
  const float infinity = Limits::infinity();
  expect_permutation(
      spatial_order(std::vector<Vec3f>{{-Limits::max(), 0, 0}, {Limits::max(), 0, 0}}), 2);
  expect_permutation(spatial_order(std::vector<Vec3f>{{0, 0, 0}, {Limits::denorm_min(), 0, 0}}), 2);
  expect_permutation(spatial_order(std::vector<Vec3f>{
                         {nan, 0, 0}, {1, infinity, 0}, {1, 1, -infinity}, {2, 2, 2}}),
                     4);
}

}  // namespace
}  // namespace meshhier::partition
