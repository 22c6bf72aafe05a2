#include "outline/crest_lines.h"

#include "outline/polyline.h"
#include "tests/outline/one_tile.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::outline {
namespace {

/// A square of side 41 in the plane of x and y, as high as `height` says.
TileMesh relief(const std::function<float(float, float)>& height) {
  tests::TestMesh mesh = tests::open_grid(41, 41);
  for (Vec3f& p : mesh.positions)
    p.z = height(p.x, p.y);
  return tests::one_tile(mesh);
}

float roof(float x, float) {
  return -0.8F * std::sqrt((x - 20) * (x - 20) + 1);
}

double longest(const std::vector<CrestLine>& lines) {
  double most = 0;
  for (const CrestLine& line : lines)
    most = std::max(most, length_of(line.points));
  return most;
}

TEST(CrestLines, ARoofHasItsRidge) {
  const std::vector<CrestLine> lines = crest_lines(relief(roof));
  ASSERT_FALSE(lines.empty());
  EXPECT_GT(longest(lines), 34);
  for (const CrestLine& line : lines) {
    for (const Vec3f& p : line.points) {
      const bool at_the_rim = p.y < 2 || p.y > 39;  // where half of the neighbours are missing
      EXPECT_NEAR(p.x, 20, at_the_rim ? 2 : 0.5);
    }
  }
}

TEST(CrestLines, AValleyIsARidgeFromBelow) {
  const auto above = crest_lines(relief(roof));
  const auto below = crest_lines(relief([](float x, float y) { return -roof(x, y); }));
  ASSERT_EQ(above.size(), below.size());
  for (std::size_t i = 0; i < above.size(); ++i) {
    EXPECT_NEAR(above[i].strength, below[i].strength, 1e-6);
    ASSERT_EQ(above[i].points.size(), below[i].points.size());
    for (std::size_t k = 0; k < above[i].points.size(); ++k)
      EXPECT_EQ(above[i].points[k].x, below[i].points[k].x);
  }
}

TEST(CrestLines, APlaneAndASphereHaveNone) {
  EXPECT_TRUE(crest_lines(relief([](float x, float y) { return 0.3F * x - 0.1F * y; })).empty());
  EXPECT_TRUE(crest_lines(tests::one_tile(tests::sphere(8000))).empty());
}

TEST(CrestLines, TheUnitOfLengthDoesNotMatter) {
  TileMesh tile = tests::one_tile(tests::torus(8000, 0.02F));
  const auto lines = crest_lines(tile);
  ASSERT_FALSE(lines.empty());
  for (Vec3f& p : tile.vertices.positions)
    p = p * 0x1p60F;
  const auto large = crest_lines(tile);
  ASSERT_EQ(lines.size(), large.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i].strength, large[i].strength);
    for (std::size_t k = 0; k < lines[i].points.size(); ++k)
      EXPECT_EQ(lines[i].points[k] * 0x1p60F, large[i].points[k]);
  }
}

TEST(CrestLines, WhatIsNoSurfaceIsNoObstacle) {
  tests::TestMesh flat = tests::open_grid(9, 9);
  for (Vec3f& p : flat.positions)
    p = {3, 3, 3};
  tests::TestMesh far = tests::sphere(500, 0.3F);
  for (Vec3f& p : far.positions)
    p = p * 1e38F;
  for (const tests::TestMesh& mesh :
       {tests::points(0), tests::points(5), tests::soup(300), flat, far}) {
    for (const CrestLine& line : crest_lines(tests::one_tile(mesh))) {
      EXPECT_GE(line.points.size(), 2U);
      EXPECT_TRUE(std::isfinite(line.strength));
      for (const Vec3f& p : line.points)
        EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    }
  }
}

}  // namespace
}  // namespace meshhier::outline
