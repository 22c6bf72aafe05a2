#include "base/closest_point.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

Vec3d random_point(std::uint64_t index) {
  return {tests::hash_noise(index, 1), tests::hash_noise(index, 2), tests::hash_noise(index, 3)};
}

TriangleFrame random_triangle(std::uint64_t index) {
  return {random_point(3 * index), random_point(3 * index + 1), random_point(3 * index + 2)};
}

/// The least distance to a fine grid of points of the triangle, and how coarse the grid is.
struct GridDistance {
  double distance = std::numeric_limits<double>::infinity();
  double step = 0;
};
GridDistance grid_distance(Vec3d x, const TriangleFrame& t) {
  constexpr int kSteps = 100;
  GridDistance best;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const Vec3d p = t.a + t.ab * (i / 100.0) + t.ac * (j / 100.0);
      best.distance = std::min(best.distance, length(x - p));
    }
  }
  best.step = (length(t.ab) + length(t.ac)) / kSteps;
  return best;
}

TEST(ClosestPointTest, IsAsNearAsTheNearestOfManyPointsOfTheTriangle) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    const TriangleFrame t = random_triangle(i);
    const Vec3d x = random_point(10000 + i);
    const GridDistance grid = grid_distance(x, t);
    const double distance = std::sqrt(squared_distance(x, t));
    EXPECT_LE(distance, grid.distance + 1e-12);
    EXPECT_GE(distance, grid.distance - grid.step);
    const ClosestPoint closest = closest_point(x, t);
    EXPECT_NEAR(std::sqrt(closest.squared_distance), distance, 1e-12);
    EXPECT_NEAR(length(x - closest.point), distance, 1e-12);
  }
}

TEST(ClosestPointTest, ItsPartsOfTheEdgesLeadToIt) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    const TriangleFrame t = random_triangle(i);
    const ClosestPoint closest = closest_point(random_point(10000 + i), t);
    EXPECT_EQ(t.a + (t.ab * closest.on_b + t.ac * closest.on_c), closest.point);
    EXPECT_GE(closest.on_b, 0);
    EXPECT_GE(closest.on_c, 0);
    EXPECT_LE(closest.on_b + closest.on_c, 1 + 1e-15);
  }
}

TEST(ClosestPointTest, AtACornerThePartsAreExact) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    // As coordinates of vertices are: floats.
    const auto corner = [&](std::uint64_t k) {
      return to_double(to_float(random_point(3 * i + k)));
    };
    const TriangleFrame t(corner(0), corner(1), corner(2));
    const auto parts = [&](std::uint64_t k) {
      const ClosestPoint closest = closest_point(corner(k), t);
      return std::array{closest.squared_distance, closest.on_b, closest.on_c};
    };
    EXPECT_EQ(parts(0), (std::array{0.0, 0.0, 0.0}));
    EXPECT_EQ(parts(1), (std::array{0.0, 1.0, 0.0}));
    EXPECT_EQ(parts(2), (std::array{0.0, 0.0, 1.0}));
  }
}

TEST(ClosestPointTest, IsInsideOnAnEdgeOrACorner) {
  const TriangleFrame t({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  EXPECT_EQ(closest_point({1, 1, 3}, t).point, (Vec3d{1, 1, 0}));
  EXPECT_EQ(closest_point({2, -1, 3}, t).point, (Vec3d{2, 0, 0}));
  EXPECT_EQ(closest_point({3, 3, 3}, t).point, (Vec3d{2, 2, 0}));
  EXPECT_EQ(closest_point({-1, 2, 3}, t).point, (Vec3d{0, 2, 0}));
  EXPECT_EQ(closest_point({-1, -1, 3}, t).point, (Vec3d{0, 0, 0}));
  EXPECT_EQ(closest_point({6, -1, 3}, t).point, (Vec3d{4, 0, 0}));
  EXPECT_EQ(closest_point({-1, 6, 3}, t).point, (Vec3d{0, 4, 0}));
  EXPECT_EQ(closest_point({-1, -1, 0}, t).squared_distance, 2);
}

TEST(ClosestPointTest, TrianglesWithoutAreaAreSegmentsAndPoints) {
  const TriangleFrame segment({0, 0, 0}, {1, 0, 0}, {3, 0, 0});
  EXPECT_DOUBLE_EQ(squared_distance({2, 1, 0}, segment), 1);
  EXPECT_DOUBLE_EQ(squared_distance({5, 0, 0}, segment), 4);
  const TriangleFrame point({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 3}, point), 4);
  EXPECT_EQ(closest_point({1, 1, 3}, point).point, (Vec3d{1, 1, 1}));
}

TEST(ClosestPointTest, NeedlesAreNotMissed) {
  for (const double width : {1e-3, 1e-5, 1e-7, 1e-9, 1e-12}) {
    const TriangleFrame needle({0, 0, 0}, {1, 0, 0}, {0.5, width, 0});
    EXPECT_NEAR(std::sqrt(squared_distance({0.4, width / 4, 0.25}, needle)), 0.25, 1e-4);
    EXPECT_NEAR(std::sqrt(closest_point({0.4, width / 4, 0}, needle).squared_distance), 0, 1e-4);
  }
}

TEST(ClosestPointTest, WorksAtTheEndsOfFloat) {
  for (const double scale : {3e38, 1e30, 1e-30, 1e-44}) {
    const TriangleFrame t({0, 0, 0}, {scale, 0, 0}, {0, scale, 0});
    EXPECT_DOUBLE_EQ(std::sqrt(squared_distance({scale / 4, scale / 4, scale / 2}, t)), scale / 2);
    EXPECT_DOUBLE_EQ(std::sqrt(squared_distance({2 * scale, 0, 0}, t)), scale);
  }
}

}  // namespace
}  // namespace meshhier
