#include "base/bounds.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

TEST(Bounds, OfNothingAreEmptyAndHaveNoDiagonal) {
  const Bounds bounds = bounds_of({});
  EXPECT_TRUE(bounds.empty());
  EXPECT_EQ(bounds, Bounds{});
  EXPECT_EQ(diagonal(bounds), 0.0);
}

TEST(Bounds, OfOnePointAreThatPoint) {
  const Vec3f point{-1.5F, 0.25F, 1e-40F};
  const Bounds bounds = bounds_of(std::span(&point, 1));
  EXPECT_FALSE(bounds.empty());
  EXPECT_EQ(bounds.min, point);
  EXPECT_EQ(bounds.max, point);
  EXPECT_EQ(diagonal(bounds), 0.0);
}

TEST(Bounds, TakeEachAxisForItself) {
  const std::vector<Vec3f> points{{1, -2, 3}, {-4, 5, 0.5F}, {2, 1, -6}};
  const Bounds bounds = bounds_of(points);
  EXPECT_EQ(bounds.min, (Vec3f{-4, -2, -6}));
  EXPECT_EQ(bounds.max, (Vec3f{2, 5, 3}));
}

TEST(Bounds, HoldTheLargestFloats) {
  constexpr float kHigh = std::numeric_limits<float>::max();
  const std::vector<Vec3f> points{{kHigh, kHigh, kHigh}};
  EXPECT_EQ(bounds_of(points).min, points[0]);
  EXPECT_EQ(bounds_of(points).max, points[0]);
  EXPECT_FALSE(bounds_of(points).empty());
}

TEST(Bounds, JoinedWithEmptyOnesStayAsTheyAre) {
  const Bounds box{{0, 1, 2}, {3, 4, 5}};
  Bounds left = box;
  left.add(Bounds{});
  EXPECT_EQ(left, box);
  Bounds right;
  right.add(box);
  EXPECT_EQ(right, box);
  Bounds nothing;
  nothing.add(Bounds{});
  EXPECT_TRUE(nothing.empty());
}

TEST(Bounds, JoinedHoldBoth) {
  Bounds box{{0, 0, 0}, {1, 1, 1}};
  box.add(Bounds{{-1, 0.5F, 2}, {0.5F, 0.75F, 3}});
  EXPECT_EQ(box, (Bounds{{-1, 0, 0}, {1, 1, 3}}));
}

TEST(Bounds, DiagonalIsTheDistanceOfTheCorners) {
  EXPECT_DOUBLE_EQ(diagonal({{1, 2, 3}, {3, 5, 9}}), 7.0);
  // Squares of such lengths overflow float.
  EXPECT_DOUBLE_EQ(diagonal({{-3e30F, 0, 0}, {0, 4e30F, 0}}),
                   length(Vec3d{double{3e30F}, double{4e30F}, 0}));
}

TEST(Bounds, InDoubleKeepWhatFloatWouldRound) {
  BoundsD bounds;
  bounds.add(Vec3d{500000.0001, -1, 0});
  bounds.add(Vec3d{500000.0002, 1, 0});
  EXPECT_EQ(bounds.min.x, 500000.0001);
  EXPECT_EQ(bounds.max.x, 500000.0002);
}

}  // namespace
}  // namespace meshhier::tests
