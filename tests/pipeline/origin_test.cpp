#include "pipeline/origin.h"

#include "tests/support/meshes.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

TEST(OriginTest, IsZeroWhereCoordinatesAreNotLargeAgainstTheLongestSide) {
  EXPECT_EQ(origin_of({{0, 0, 0}, {1, 1, 1}}), Vec3d{});
  EXPECT_EQ(origin_of({{-3, 5, 1}, {4, 14, 2}}), Vec3d{});
  EXPECT_EQ(origin_of({{1e6, -1e6, 0}, {3e6, 1e6, 1}}), Vec3d{});
  EXPECT_EQ(origin_of({}), Vec3d{});
  EXPECT_FALSE(is_far_from_zero({{0, 0, 0}, {1, 1, 1}}));
  EXPECT_FALSE(is_far_from_zero({}));
}

TEST(OriginTest, IsNearTheMiddleOfAxesWhoseCoordinatesAreLarge) {
  const BoundsD box{{447213, -5428781, 298}, {447263, -5428731, 304}};
  EXPECT_TRUE(is_far_from_zero(box));
  EXPECT_EQ(origin_of(box), (Vec3d{447238, -5428756, 301}));
  EXPECT_EQ(origin_of({{447213, 20, -30}, {447263, 70, 30}}), (Vec3d{447238, 0, 0}));
}

TEST(OriginTest, OfASmallMeshOfDoublesIsWithinIt) {
  const Vec3d origin = origin_of({{5428731.1234, 0, 0}, {5428731.1235, 0.0001, 0}});
  EXPECT_GT(origin.x, 5428731.1234);
  EXPECT_LT(origin.x, 5428731.1235);
  EXPECT_EQ(origin_of({{7.25, 0, 0}, {7.25, 0, 0}}).x, 7.25);  // one point
}

/// Any floats, in boxes of any size about anywhere.
TEST(OriginTest, FloatsStayExact) {
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const auto noise = [&](std::uint64_t k) { return double{tests::hash_noise(i, k)}; };
    const double far = std::ldexp(1 + noise(1), static_cast<int>(noise(2) * 40));
    const double size = far * std::ldexp(1, -1 - static_cast<int>((1 + noise(3)) * 13));
    const auto near = [&](std::uint64_t k) { return static_cast<float>(far + size * noise(k)); };
    BoundsD box;
    for (std::uint64_t k = 10; k < 16; ++k)
      box.add(Vec3d{near(k), size * noise(k), 0});
    const Vec3d origin = origin_of(box);
    if (box.max.x - box.min.x > far * 0x1p-20) {
      ASSERT_EQ(double{static_cast<float>(-origin.x)}, -origin.x);  // so does 0
    }
    for (std::uint64_t k = 10; k < 16; ++k) {
      const Vec3d point{near(k), 0, 0};
      const Vec3f stored = to_float(point - origin);
      ASSERT_EQ(double{stored.x} + origin.x, point.x) << "far " << far << ", size " << size;
    }
  }
}

TEST(OriginTest, StraysAreSuspectedWhereFewCellsAreFilled) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 10'000; ++i)
    points.push_back({447213 + i % 100 * 0.5, 5428731 + i / 100 * 0.5, 300});
  BoundsD box;
  for (const Vec3d& p : points)
    box.add(p);
  EXPECT_FALSE(may_have_strays(points, box));
  for (const Vec3d stray : {Vec3d{0, 0, 0}, Vec3d{447213, 0, 300}, Vec3d{1e12, 5428731, 300}}) {
    BoundsD wide = box;
    wide.add(stray);
    EXPECT_TRUE(may_have_strays(points, wide));
  }
  EXPECT_FALSE(may_have_strays({}, {}));
}

}  // namespace
}  // namespace meshhier::pipeline
