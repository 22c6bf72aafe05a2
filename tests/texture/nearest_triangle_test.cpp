#include "texture/nearest_triangle.h"

#include "base/closest_point.h"
#include "tests/texture/random_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

constexpr int kSquares = 24;

/// A rough sheet over [0, 24]^2, and the same again below it, turned over.
std::vector<SurfaceTriangle> two_sheets() {
  RandomNumbers random(7);
  std::vector<float> heights;
  for (int i = 0; i < (kSquares + 1) * (kSquares + 1); ++i)
    heights.push_back(static_cast<float>(random.part()));
  const auto corner = [&](int x, int y, float below) {
    const auto i = static_cast<std::size_t>(y * (kSquares + 1) + x);
    return Vec3f{static_cast<float>(x), static_cast<float>(y), heights[i] - below};
  };
  std::vector<SurfaceTriangle> triangles;
  for (int y = 0; y < kSquares; ++y) {
    for (int x = 0; x < kSquares; ++x) {
      triangles.push_back({corner(x, y, 0), corner(x + 1, y, 0), corner(x, y + 1, 0)});
      triangles.push_back({corner(x + 1, y + 1, 0), corner(x, y + 1, 0), corner(x + 1, y, 0)});
      triangles.push_back({corner(x, y, 0.4F), corner(x, y + 1, 0.4F), corner(x + 1, y, 0.4F)});
    }
  }
  return triangles;
}

NearestTriangle tree_of(const std::vector<SurfaceTriangle>& triangles) {
  return {triangles, {kSquares / 2.0, kSquares / 2.0, 0}, 2 * kSquares};
}

double distance_to(const SurfaceTriangle& t, const Vec3d& point) {
  return std::sqrt(squared_distance(point, {to_double(t[0]), to_double(t[1]), to_double(t[2])}));
}

/// Returns the least distance to triangles that face as asked within reach, else to all.
double least_distance(const std::vector<SurfaceTriangle>& triangles, const Vec3d& point,
                      const Vec3d& facing, double reach) {
  double alike = std::numeric_limits<double>::infinity(), any = alike;
  for (const SurfaceTriangle& t : triangles) {
    const double distance = distance_to(t, point);
    any = std::min(any, distance);
    if (dot(to_double(cross(t[1] - t[0], t[2] - t[0])), facing) > 0)
      alike = std::min(alike, distance);
  }
  return alike <= reach ? alike : any;
}

struct Asking {
  double block = 1;  ///< side of the boxes that are asked for
  double above = 0;  ///< height of the sheet
  double reach = 10;
};

/// Asks for points of blocks, and of everywhere between them.
void expect_nearest(const Asking& asking) {
  const std::vector<SurfaceTriangle> triangles = two_sheets();
  NearestTriangle nearest = tree_of(triangles);
  RandomNumbers random(3);
  for (int block = 0; block < 40; ++block) {
    const Vec3d low{random.part() * kSquares, random.part() * kSquares, asking.above};
    const Vec3d size{asking.block, asking.block, asking.block};
    for (int i = 0; i < 20; ++i) {
      const double far = i % 10 == 9 ? 3.0 : 1.0;  // some are not beside the last one
      const Vec3d point =
          low + Vec3d{random.part() * size.x, random.part() * size.y, random.part() * size.z} * far;
      const Vec3d facing{0, 0, i % 3 == 0 ? -1.0 : 1.0};
      const NearestTriangle::Found found = nearest(point, facing, asking.reach);
      ASSERT_LT(found.triangle, triangles.size());
      const double least = least_distance(triangles, point, facing, asking.reach);
      ASSERT_NEAR(distance_to(triangles[found.triangle], point), least, 1e-4);
    }
  }
}

TEST(NearestTriangle, IsTheNearestOfThoseThatFaceAlike) {
  for (const double block : {0.1, 1.0, 5.0}) {
    for (const double above : {0.0, 2.0, -20.0})
      expect_nearest({block, above, 100});
  }
}

TEST(NearestTriangle, IsAnyBeyondReach) {
  expect_nearest({1, 0.5, 0.3});
  expect_nearest({1, 8, 0.3});
}

// The last answer is near, or far, and tells nothing of the next one.
TEST(NearestTriangle, IsFoundWhateverWasAskedBefore) {
  const std::vector<SurfaceTriangle> triangles = two_sheets();
  NearestTriangle nearest = tree_of(triangles);
  for (const double height : {0.5, 3.0, 10.0, 1e3, 0.5, 1e6}) {
    const Vec3d point{3.25, 3.75, height};
    const NearestTriangle::Found found = nearest(point, {0, 0, 1}, 1e9);
    const double least = least_distance(triangles, point, {0, 0, 1}, 1e9);
    EXPECT_NEAR(distance_to(triangles[found.triangle], point), least, 1e-4 * (1 + height));
  }
}

TEST(NearestTriangle, OfFewTrianglesOrNone) {
  const std::vector<SurfaceTriangle> one{{Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}}};
  NearestTriangle nearest = tree_of(one);
  EXPECT_EQ(nearest({0.25, 0.25, 0.5}, {0, 0, 1}, 1).triangle, 0U);
  EXPECT_EQ(nearest({5, 5, 5}, {0, 0, -1}, 1).triangle, 0U);
  NearestTriangle none = tree_of({});
  EXPECT_EQ(none({0, 0, 0}, {0, 0, 1}, 1).triangle, NearestTriangle::kNone);
}

TEST(NearestTriangle, OfEquallyNearOnesTheFirst) {
  std::vector<SurfaceTriangle> triangles = two_sheets();
  const std::size_t count = triangles.size();
  for (std::size_t i = 0; i < count; ++i)
    triangles.push_back(triangles[i]);
  NearestTriangle nearest = tree_of(triangles);
  RandomNumbers random(5);
  for (int i = 0; i < 300; ++i) {
    const Vec3d point{random.part() * kSquares, random.part() * kSquares, random.part()};
    EXPECT_LT(nearest(point, {0, 0, 1}, 5).triangle, count);
  }
}

}  // namespace
}  // namespace meshhier::texture
