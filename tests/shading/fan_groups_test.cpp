#include "shading/fan_groups.h"

#include "shading/crease.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::shading {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// A normal in the plane of x and z, so many degrees from z.
Vec3d tilted(double degrees, double area = 1) {
  const double angle = degrees * std::numbers::pi / 180;
  return {area * std::sin(angle), 0, area * std::cos(angle)};
}

/// Triangles around a place, each sharing an edge with the next, the last with the first.
std::vector<FanCorner> closed_fan(const std::vector<Vec3d>& areas) {
  std::vector<FanCorner> corners;
  for (std::uint32_t i = 0; i < areas.size(); ++i)
    corners.push_back({(i + 1) % static_cast<std::uint32_t>(areas.size()), i, areas[i]});
  return corners;
}

FanGroups group_fans(const std::vector<FanCorner>& corners) {
  std::uint32_t places = 0;
  for (const FanCorner& corner : corners)
    places = std::max({places, corner.next + 1, corner.previous + 1});
  return FanGrouper(places).group(corners);
}

bool is_one_fan(const std::vector<FanCorner>& corners) {
  return group_fans(corners).is_one_fan;
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(dot(a, b) / length(a) / length(b)) * 180 / std::numbers::pi;
}

TEST(FanGroups, ASmoothFanIsOneGroupWithItsMeanByArea) {
  const FanGroups groups = group_fans(closed_fan({tilted(-10, 3), tilted(0), tilted(10)}));
  EXPECT_THAT(groups.group_of, Each(0));
  ASSERT_THAT(groups.normals, SizeIs(1));
  const Vec3d mean = tilted(-10, 3) + tilted(0) + tilted(10);
  EXPECT_NEAR(degrees_between(groups.normals[0], mean), 0, 1e-6);
}

TEST(FanGroups, ACubesCornerHasThreeGroups) {
  const FanGroups groups = group_fans(closed_fan({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_THAT(groups.group_of, ElementsAre(0, 1, 2));
  EXPECT_THAT(groups.normals, ElementsAre(Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}));
}

TEST(FanGroups, TheLargestComesFirst) {
  const FanGroups groups = group_fans(closed_fan({{1, 0, 0}, {0, 3, 0}, {0, 0, 2}}));
  EXPECT_THAT(groups.group_of, ElementsAre(2, 0, 1));
}

// The fan leads around the other way.
TEST(FanGroups, OneSharpEdgeSplitsNothing) {
  const double far = 0.75 * kCreaseAngle;
  const FanGroups groups =
      group_fans(closed_fan({tilted(-far), tilted(-far / 3), tilted(far / 3), tilted(far)}));
  EXPECT_THAT(groups.group_of, Each(0));
}

TEST(FanGroups, TwoSharpEdgesDo) {
  const double far = 0.75 * kCreaseAngle;
  const FanGroups groups =
      group_fans(closed_fan({tilted(-far), tilted(-far - 5), tilted(far), tilted(far + 5)}));
  EXPECT_THAT(groups.group_of, ElementsAre(0, 0, 1, 1));
}

TEST(FanGroups, PiecesThatOnlyTouchAreOneGroupIfTheyAreAlike) {
  const FanGroups groups =
      group_fans(std::vector<FanCorner>{{1, 2, tilted(0)}, {3, 4, tilted(kCreaseAngle - 1)}});
  EXPECT_THAT(groups.group_of, Each(0));
  const FanGroups apart =
      group_fans(std::vector<FanCorner>{{1, 2, tilted(0)}, {3, 4, tilted(kCreaseAngle + 1)}});
  EXPECT_THAT(apart.group_of, ElementsAre(0, 1));
}

// A chain of turns of 50 degrees, but with a third triangle at one of its edges.
TEST(FanGroups, AnEdgeOfThreeTrianglesIsSharp) {
  const std::vector<FanCorner> chain{{1, 2, tilted(0)}, {2, 3, tilted(50)}, {3, 4, tilted(100)}};
  EXPECT_THAT(group_fans(chain).group_of, Each(0));
  std::vector<FanCorner> book = chain;
  book.push_back({2, 9, tilted(180)});
  EXPECT_THAT(group_fans(book).normals, SizeIs(testing::Gt(1U)));
}

TEST(FanGroups, OppositeSheetsStayApart) {
  const FanGroups groups =
      group_fans(std::vector<FanCorner>{{1, 2, {0, 0, 1}}, {2, 1, {0, 0, -1}}});
  EXPECT_THAT(groups.group_of, ElementsAre(0, 1));
}

TEST(FanGroups, WhatHasNoAreaLeadsNoGroup) {
  const FanGroups groups =
      group_fans(std::vector<FanCorner>{{1, 2, {}}, {2, 3, {0, 0, 1}}, {7, 8, {}}});
  EXPECT_THAT(groups.normals, ElementsAre(Vec3d{0, 0, 1}));
  EXPECT_THAT(groups.group_of, Each(0));
  EXPECT_THAT(group_fans(std::vector<FanCorner>{{1, 2, {}}}).normals, ElementsAre(Vec3d{}));
  EXPECT_THAT(group_fans({}).normals, SizeIs(1));
  EXPECT_THAT(group_fans({}).group_of, IsEmpty());
}

TEST(FanGroups, OneFanIsOneGroupOfAllAreas) {
  std::size_t found = 0;
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    std::vector<Vec3d> areas;
    for (std::uint32_t i = 0; i < 3 + seed % 20; ++i)  // more than are few, too
      areas.push_back(tilted(std::fmod(37.0 * seed * i, 10.0 + seed % 120), 1 + seed % 3));
    std::vector<FanCorner> corners = closed_fan(areas);
    if (seed % 5 == 0)
      corners.pop_back();  // open
    if (seed % 7 == 0)
      corners.push_back({1, 99, tilted(80)});  // an edge of three
    if (!is_one_fan(corners))
      continue;
    ++found;
    Vec3d sum;
    for (const FanCorner& corner : corners)
      sum = sum + corner.area;
    const FanGroups groups = group_fans(corners);
    EXPECT_THAT(groups.normals, ElementsAre(sum));
    EXPECT_THAT(groups.group_of, Each(0));
  }
  EXPECT_GT(found, 100U);
  EXPECT_LT(found, 450U);
  EXPECT_FALSE(is_one_fan(closed_fan({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})));
  EXPECT_TRUE(is_one_fan(closed_fan({tilted(-10, 3), tilted(0), tilted(10)})));
}

/// Around a place inside a surface, with creases.
std::vector<FanCorner> folded_fan(std::uint32_t seed) {
  std::vector<Vec3d> areas;
  for (std::uint32_t i = 0; i < 3 + seed % 20; ++i)
    areas.push_back(tilted(std::fmod(53.0 * seed * (i / 2), 30.0 + seed % 170), 1 + seed % 3));
  return closed_fan(areas);
}

// With one triangle turned over the same fan has no round to walk, but the same edges.
TEST(FanGroups, ARoundHasTheGroupsOfItsEdges) {
  std::size_t several = 0;
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    std::vector<FanCorner> corners = folded_fan(seed);
    const FanGroups round = group_fans(corners);
    FanCorner& turned = corners[seed % corners.size()];
    std::swap(turned.next, turned.previous);
    const FanGroups edges = group_fans(corners);
    EXPECT_EQ(round.group_of, edges.group_of) << seed;
    EXPECT_EQ(round.normals, edges.normals) << seed;
    EXPECT_EQ(round.is_one_fan, edges.is_one_fan) << seed;
    several += std::size_t{round.normals.size() > 1};
  }
  EXPECT_GT(several, 100U);
  EXPECT_LT(several, 450U);
}

TEST(FanGroups, WhatAnotherPlaceLeftIsForgotten) {
  FanGrouper grouper(100);
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    std::vector<FanCorner> corners = folded_fan(seed * 7);
    if (seed % 3 == 0)
      corners.erase(corners.begin());  // open
    const FanGroups alone = group_fans(corners);
    const FanGroups& next = grouper.group(corners);
    EXPECT_EQ(next.group_of, alone.group_of) << seed;
    EXPECT_EQ(next.normals, alone.normals) << seed;
  }
}

TEST(FanGroups, ManyTrianglesMakeFewGroups) {
  std::vector<FanCorner> corners;
  for (std::uint32_t i = 0; i < 200'000; ++i) {
    const double turn = 0.7 * i;
    corners.push_back({2 * i, 2 * i + 1, {std::sin(turn), std::cos(turn), std::sin(1.3 * turn)}});
  }
  const FanGroups groups = group_fans(corners);
  EXPECT_THAT(groups.normals, SizeIs(testing::Le(32U)));
  for (std::size_t i = 0; i < corners.size(); ++i)
    ASSERT_LT(groups.group_of[i], groups.normals.size());
}

}  // namespace
}  // namespace meshhier::shading
