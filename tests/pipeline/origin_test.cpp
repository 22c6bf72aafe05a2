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

/// 40 x 40 points over a box; on its floor, and up to its ceiling along one diagonal.
std::vector<Vec3d> points_over(const BoundsD& box) {
  std::vector<Vec3d> points;
  const Vec3d size = box.max - box.min;
  for (int i = 0; i < 1600; ++i) {
    const double u = i % 40 / 39.0, v = i / 40 / 39.0;
    points.push_back(box.min + Vec3d{size.x * u, size.y * v, size.z * u * v});
  }
  return points;
}

BoundsD box_over(const std::vector<Vec3d>& points) {
  BoundsD box;
  for (const Vec3d& p : points)
    box.add(p);
  return box;
}

Origin origin_over(const std::vector<Vec3d>& points) {
  const Origin chosen = choose_origin(box_over(points), core_of(points), points.size());
  EXPECT_TRUE(chosen.at == Vec3d{} || may_need_origin(points, box_over(points), points.size()));
  return chosen;
}

/// How many steps the floats of a box have along an axis.
double steps_along(int axis, const BoundsD& box, Vec3d origin) {
  const double reach =
      std::max(std::abs(box.min[axis] - origin[axis]), std::abs(box.max[axis] - origin[axis]));
  return (box.max[axis] - box.min[axis]) / (reach * 0x1p-24);
}

TEST(OriginTest, EachAxisHasItsOwn) {
  // Degrees, and heights in metres, whatever these are.
  for (const double height : {0.0, 0.1, 4.0, 40.0, 400.0, 8000.0, 1e6}) {
    for (const double span : {1e-5, 0.0004, 0.01, 1.0}) {
      const BoundsD box{{139.7, -35.65, 0}, {139.7 + span, -35.65 + span, height}};
      const Vec3d origin = origin_over(points_over(box)).at;
      for (const int axis : {0, 1})
        EXPECT_GE(steps_along(axis, box, origin), 40e3) << height << ' ' << span;
      EXPECT_EQ(origin.z, 0) << height << ' ' << span;
    }
  }
}

TEST(OriginTest, WhereFloatsAreFineItIsThatOfTheBox) {
  const std::vector<BoundsD> boxes{{{0, 0, 299}, {1000, 1000, 304}},
                                   {{0.5, 0, 0}, {0.5, 1, 1}},
                                   {{-1, -1, 0.4}, {1, 1, 0.5}},
                                   {{10, 0, 0}, {13, 9, 1}},
                                   {{447213, 5428731, 298}, {447263, 5428781, 304}}};
  for (const BoundsD& box : boxes) {
    const Origin chosen = origin_over(points_over(box));
    EXPECT_EQ(chosen.at, origin_of(box));
    EXPECT_EQ(chosen.near, Origin::kEverywhere);
  }
}

TEST(OriginTest, AFewStraysChooseNothing) {
  const BoundsD scan{{447123.1, 5428731.2, 299}, {447126.1, 5428734.2, 301}};
  for (const Vec3d stray : {Vec3d{0, 0, 0}, Vec3d{447124, 0, 300}, Vec3d{447124, 5428733, 1e7},
                            Vec3d{400000, 5400000, 0}, Vec3d{-1e9, 1e9, 5}}) {
    for (const std::size_t count : {1U, 3U, 40U}) {
      std::vector<Vec3d> points = points_over(scan);
      points.insert(points.begin() + 700, count, stray);
      const Origin chosen = origin_over(points);
      for (const int axis : {0, 1, 2})
        EXPECT_GT(steps_along(axis, scan, chosen.at), 1e5) << stray.x << ' ' << stray.y;
      BoundsD both = chosen.near;
      both.add(stray);
      EXPECT_NE(both, chosen.near) << "it is not told";
      EXPECT_LT(rounding_of(points, chosen.at), 1e-6);
    }
  }
}

TEST(OriginTest, TheCoreLeavesOutAsManyPointsAtBothEnds) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 64; ++i)
    points.push_back({static_cast<double>(i * 7 % 64), 5, static_cast<double>(-i)});
  EXPECT_EQ(core_of(points), (BoundsD{{2, 5, -61}, {61, 5, -2}}));
  points.resize(7);
  EXPECT_EQ(core_of(points), box_over(points));
  EXPECT_TRUE(core_of({}).empty());
}

TEST(OriginTest, WhatFloatsLoseIsMeasured) {
  std::vector<Vec3d> points(100, Vec3d{1, 0.5, 3});
  EXPECT_EQ(rounding_of(points, {}), 0);
  points[17].x = 0.1;  // one of a hundred
  EXPECT_EQ(rounding_of(points, {}), 0);
  for (Vec3d& p : points)
    p.x = 1 + 0x1p-30;
  EXPECT_EQ(rounding_of(points, {}), 0x1p-30);
  EXPECT_EQ(rounding_of(points, {1, 0, 0}), 0);
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
