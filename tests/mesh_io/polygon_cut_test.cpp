#include "mesh_io/polygon_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

using Polygon = std::vector<Vec3d>;
using Kind = PolygonCut::Kind;

Polygon flat(const std::vector<std::array<double, 2>>& corners) {
  Polygon polygon;
  for (const auto& [x, y] : corners)
    polygon.push_back({x, y, 0});
  return polygon;
}

Vec3d area_of(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return cross(b - a, c - a) * 0.5;
}

/// Signed, about z.
double area_of(const Polygon& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3d& a = p[i];
    const Vec3d& b = p[(i + 1) % p.size()];
    sum += (a.x * b.y - a.y * b.x) / 2;
  }
  return sum;
}

/// Returns whether the triangles of a flat polygon all turn as it does and have its area: then they
/// cover it, once.
void expect_covered(const Polygon& polygon) {
  PolygonCut cut;
  ASSERT_EQ(cut.cut(polygon), Kind::cut);
  if (polygon.size() <= PolygonCut::kMostEars) {
    ASSERT_EQ(cut.triangles().size(), polygon.size() - 2);
  }
  const double whole = area_of(polygon);
  double sum = 0;
  for (const Triangle<std::uint32_t>& t : cut.triangles()) {
    const double part = area_of(polygon[t[0]], polygon[t[1]], polygon[t[2]]).z;
    EXPECT_GE(part * whole, -1e-12 * whole * whole);
    sum += part;
  }
  EXPECT_NEAR(sum, whole, 1e-12 * std::abs(whole));
}

/// From each corner on, in both directions; looked at from both sides of each axis.
void expect_covered_all_ways(const Polygon& polygon) {
  Polygon turned = polygon;
  PolygonCut cut;
  for (std::size_t first = 0; first < polygon.size(); ++first) {
    std::ranges::rotate(turned, turned.begin() + 1);
    Polygon reversed = turned;
    std::ranges::reverse(reversed);
    for (const Polygon& one : {turned, reversed}) {
      const Kind kind = cut.cut(one);
      ASSERT_NE(kind, Kind::crossed);
      if (kind == Kind::cut)
        expect_covered(one);
      const std::vector<Triangle<std::uint32_t>> triangles(cut.triangles().begin(),
                                                           cut.triangles().end());
      Polygon other = one;
      for (int axis = 0; axis < 3; ++axis) {
        for (Vec3d& p : other)
          p = {p.z, p.x, p.y};
        ASSERT_EQ(cut.cut(other), kind);
        if (kind == Kind::cut) {
          EXPECT_TRUE(std::ranges::equal(cut.triangles(), triangles));
        }
      }
    }
  }
}

TEST(PolygonCut, ConvexPolygonsAreFans) {
  PolygonCut cut;
  for (int corners = 3; corners < 40; ++corners) {
    Polygon polygon;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      polygon.push_back({std::cos(angle), std::sin(angle), 0.1 * std::sin(5 * angle)});
    }
    EXPECT_EQ(cut.cut(polygon), Kind::fan);
    std::ranges::reverse(polygon);
    EXPECT_EQ(cut.cut(polygon), Kind::fan);
  }
  EXPECT_EQ(cut.cut(flat({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {0, 1}})), Kind::fan) << "on a line";
  EXPECT_EQ(cut.cut(flat({{0, 0}, {2, 0}, {2, 1}, {2, 2}, {0, 2}, {0, 2}})), Kind::fan) << "twice";
}

TEST(PolygonCut, WhatHasNoAreaIsAFan) {
  PolygonCut cut;
  EXPECT_EQ(cut.cut(flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}})), Kind::fan);
  EXPECT_EQ(cut.cut(Polygon(5, Vec3d{1, 2, 3})), Kind::fan);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cut.cut(Polygon{{0, 0, 0}, {1, 0, 0}, {nan, nan, nan}, {0, 1, 0}}), Kind::fan);
}

TEST(PolygonCut, ShapesAreCovered) {
  const std::vector<std::vector<std::array<double, 2>>> shapes{
      {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}},                  // an L
      {{4, 0}, {4, 1}, {1, 1}, {1, 3}, {4, 3}, {4, 4}, {0, 4}, {0, 0}},  // a C
      {{0, 0}, {2, 1}, {0, 2}, {0.5, 1}},                                // an arrow
      {{0, 0},
       {6, 0},
       {6, 5},
       {1, 5},
       {1, 2},
       {4, 2},
       {4, 3},
       {2, 3},
       {2, 4},
       {5, 4},
       {5, 1},
       {0, 1}},                                                                          // a spiral
      {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}},  // a hole
      {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}},  // corners on lines
      {{0, 0}, {3, 0}, {3, 3}, {2, 1}, {1, 3}, {1, 1}, {0, 3}}};
  for (const auto& shape : shapes)
    expect_covered_all_ways(flat(shape));
}

TEST(PolygonCut, StarsAndCombsOfAnySizeAreCovered) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> radius(0.1, 1);
  for (const int corners : {4, 5, 8, 33, 200, 1024}) {
    for (int round = 0; round < (corners < 100 ? 50 : 2); ++round) {
      Polygon star;
      for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        const double r = radius(random);
        star.push_back({r * std::cos(angle), r * std::sin(angle), 0});
      }
      PolygonCut cut;
      if (cut.cut(star) != Kind::fan)
        expect_covered(star);
    }
  }
  Polygon comb{{0, -1, 0}, {511, -1, 0}};
  for (int i = 511; i >= 0; --i)
    comb.push_back({static_cast<double>(i), i % 2 == 0 ? 10.0 : 0.0, 0});
  expect_covered(comb);
  // Far from zero, where numbers have few digits left.
  Polygon far = comb;
  for (Vec3d& p : far)
    p = {p.x + 1e15, p.y - 3e15, p.z};
  PolygonCut cut;
  EXPECT_EQ(cut.cut(far), Kind::cut);
}

/// With the outline between corners that are on lines, so that it has more than kMostEars.
Polygon refined(const Polygon& polygon, int parts) {
  Polygon fine;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& a = polygon[i];
    const Vec3d& b = polygon[(i + 1) % polygon.size()];
    for (int k = 0; k < parts; ++k)
      fine.push_back(a + (b - a) * (static_cast<double>(k) / parts));
  }
  return fine;
}

TEST(PolygonCut, LargePolygonsAreCoveredToo) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> radius(0.1, 1);
  Polygon star;
  for (int i = 0; i < 5000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 5000;
    const double r = radius(random);
    star.push_back({r * std::cos(angle), r * std::sin(angle), 0});
  }
  expect_covered(star);
  std::ranges::reverse(star);
  expect_covered(star);
  Polygon comb{{0, -1, 0}, {20000, -1, 0}};
  for (int i = 20000; i >= 0; --i)
    comb.push_back({static_cast<double>(i), i % 2 == 0 ? 10.0 : 0.0, 0});
  expect_covered(comb);
  // A spiral, whose corners lie on lines.
  expect_covered(refined(flat({{0, 0},
                               {6, 0},
                               {6, 5},
                               {1, 5},
                               {1, 2},
                               {4, 2},
                               {4, 3},
                               {2, 3},
                               {2, 4},
                               {5, 4},
                               {5, 1},
                               {0, 1}}),
                         128));
}

TEST(PolygonCut, ALargePolygonMayTouchItself) {
  // A hole by a bridge, which the outline runs along there and back.
  const Polygon hole = refined(
      flat({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}}), 128);
  EXPECT_NEAR(area_of(hole), 48, 1e-9);
  expect_covered(hole);
  // Corners of the bridge are those on whose side a triangle lies.
  PolygonCut cut;
  ASSERT_EQ(cut.cut(hole), Kind::cut);
  const auto middle = [&](const Triangle<std::uint32_t>& t) {
    return (hole[t[0]] + hole[t[1]] + hole[t[2]]) * (1.0 / 3);
  };
  const auto is_on_bridge = [](std::uint32_t i) { return i > 4 * 128 && i < 5 * 128; };
  const auto is_on_way_back = [](std::uint32_t i) { return i > 9 * 128; };
  int sides = 0;
  for (const Triangle<std::uint32_t>& t : cut.triangles()) {
    const Vec3d p = middle(t);
    for (const std::uint32_t i : t) {
      EXPECT_FALSE(is_on_bridge(i) && p.x > p.y) << "on the way there the inside is to the left";
      EXPECT_FALSE(is_on_way_back(i) && p.x < p.y);
      sides |= is_on_bridge(i) ? 1 : is_on_way_back(i) ? 2 : 0;
    }
  }
  EXPECT_EQ(sides, 3);
  // Two parts that touch at a point.
  expect_covered(refined(flat({{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}), 256));
}

TEST(PolygonCut, LargePolygonsThatCrossThemselvesAreTold) {
  PolygonCut cut;
  EXPECT_EQ(cut.cut(refined(flat({{0, 0}, {2, 2}, {2, 0}, {0, 1}}), 512)), Kind::crossed);
  Polygon twice = refined(flat({{4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}, {0, 0}}), 256);
  const Polygon once = twice;
  twice.insert(twice.end(), once.begin(), once.end());
  EXPECT_EQ(cut.cut(twice), Kind::crossed) << "it winds twice";
}

TEST(PolygonCut, AQuadIsCutAtTheCornerThatPointsInwards) {
  const Polygon arrow = flat({{0, 0}, {2, 1}, {0, 2}, {0.5, 1}});
  PolygonCut cut;
  Polygon turned = arrow;
  for (int first = 0; first < 4; ++first) {
    const bool begins_at_diagonal = turned[0] == arrow[1] || turned[0] == arrow[3];
    EXPECT_EQ(cut.cut(turned), begins_at_diagonal ? Kind::fan : Kind::cut);
    std::ranges::rotate(turned, turned.begin() + 1);
  }
}

TEST(PolygonCut, PolygonsThatCrossThemselvesAreTold) {
  PolygonCut cut;
  EXPECT_EQ(cut.cut(flat({{0, 0}, {2, 2}, {2, 0}, {0, 1}})), Kind::crossed);
  EXPECT_EQ(cut.cut(flat({{0, 0}, {3, 3}, {3, 0}, {0, 1}})), Kind::crossed);
}

TEST(PolygonCut, TheSurfaceNeedNotBeFlat) {
  // An L whose corners stand at any height.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> height(-0.3, 0.3);
  for (int round = 0; round < 100; ++round) {
    Polygon bent = flat({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}});
    for (Vec3d& p : bent)
      p.z = height(random);
    PolygonCut cut;
    std::ranges::rotate(bent, bent.begin() + round % 6);
    if (cut.cut(bent) == Kind::cut) {
      double sum = 0;
      for (const Triangle<std::uint32_t>& t : cut.triangles())
        sum += area_of(bent[t[0]], bent[t[1]], bent[t[2]]).z;
      EXPECT_NEAR(sum, 7, 1e-12);
    }
  }
}

}  // namespace
}  // namespace meshhier::mesh_io
