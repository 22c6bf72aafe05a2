#include "cluster_simplify/fan_gap.h"

#include "tests/cluster_simplify/stars.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::largest_deviation;
using tests::Star;
using tests::StarMesh;
using tests::StarShape;

constexpr int kSeeds = 300;  // stars of a family

struct Family {
  StarShape shape;
  tests::StarRelief relief;
  int least = 0;  ///< so many of kSeeds stars must be measured: others cannot be laid flat
};

std::vector<Family> families() {
  std::vector<Family> result;
  for (const auto& [shape, name] :
       {std::pair{StarShape::closed, "closed, "}, std::pair{StarShape::border_edge, "edge, "},
        std::pair{StarShape::border_end, "end, "}}) {
    const std::string text = name;
    result.push_back({shape, {text + "flat"}, kSeeds / 3});
    result.push_back({shape, {text + "bumpy", 0.2}, kSeeds / 3});
    result.push_back({shape, {text + "steep", 1.5}, kSeeds / 8});
    result.push_back({shape, {text + "creased", 0.02, 1.5}, kSeeds / 8});
    result.push_back({shape, {text + "folded", 0.01, 20}, 0});
    result.push_back({shape, {text + "bowl", 0.05, 0, 1}, kSeeds / 8});
  }
  return result;
}

std::optional<DiscGap> measure(FanGapMeter& meter, const Star& star, const StarMesh& mesh) {
  return meter.measure(star.mesh.positions, star.deviations, mesh.collapse());
}

TEST(FanGapTest, SLOW_NoSampleIsBeyondTheDeviations) {
  FanGapMeter meter;
  for (const auto& [shape, relief, least] : families()) {
    const int measured = expect_all_covered(
        shape, relief, kSeeds,
        [&](const Star& star, const StarMesh& mesh) { return measure(meter, star, mesh); });
    ASSERT_GE(measured, least) << relief.name;
  }
}

TEST(FanGapTest, IsNotLooseOnBumps) {
  FanGapMeter meter;
  for (const StarShape shape : {StarShape::closed, StarShape::border_edge, StarShape::border_end}) {
    const tests::Looseness looseness = looseness_of(
        shape, {"bumpy", 0.2}, kSeeds,
        [&](const Star& star, const StarMesh& mesh) { return measure(meter, star, mesh); });
    EXPECT_GT(looseness.stars, 0);
    EXPECT_LE(looseness.mean, 3) << static_cast<int>(shape);
  }
}

/// A roof: two rows of squares that meet in the line y = 0, at height `slope`.
Star roof(float slope) {
  const auto at = [&](int x, int y) {
    return Vec3f{static_cast<float>(x), static_cast<float>(y), y == 0 ? slope : 0.0F};
  };
  return {{{at(0, 0), at(1, 0), at(-1, 0), at(-1, -1), at(0, -1), at(1, -1), at(2, 0), at(2, 1),
            at(1, 1), at(0, 1)},
           {{0, 1, 9},
            {1, 8, 9},
            {1, 7, 8},
            {1, 6, 7},
            {0, 9, 2},
            {0, 2, 3},
            {0, 3, 4},
            {0, 4, 1},
            {1, 4, 5},
            {1, 5, 6}}},
          0,
          1,
          {0.5F, 0, slope},
          std::vector<float>(10)};
}

TEST(FanGapTest, AlongARidgeNothingMoves) {
  FanGapMeter meter;
  for (const float slope : {0.0F, 0.5F, 2.0F, 10.0F}) {
    const Star star = roof(slope);
    const StarMesh mesh(star);
    const std::optional<DiscGap> gap = measure(meter, star, mesh);
    ASSERT_TRUE(gap) << slope;
    expect_covers(star, mesh, *gap);
    EXPECT_NEAR(gap->from, 0, 1e-6);
    EXPECT_NEAR(gap->to, 0, 1e-6);
  }
}

TEST(FanGapTest, AStraightBorderOfFlatGroundStaysWhereItIs) {
  // The border y = 0; an end, or both, on it.
  const tests::TestMesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0.5F, 1, 0}, {-1, 1, 0}, {-1, 0, 0}},
      {{0, 1, 4}, {1, 3, 4}, {1, 2, 3}, {0, 4, 5}, {0, 5, 6}}};
  FanGapMeter meter;
  for (const Vec3f place : {mesh.positions[0], mesh.positions[1], Vec3f{0.5F, 0, 0}}) {
    const Star star{mesh, 0, 1, place, std::vector<float>(5)};
    const StarMesh star_mesh(star);
    const std::optional<DiscGap> gap = measure(meter, star, star_mesh);
    ASSERT_TRUE(gap);
    EXPECT_LE(expect_covers(star, star_mesh, *gap), 1e-12);
    EXPECT_LE(largest_deviation(*gap), 1e-5F);
  }
}

TEST(FanGapTest, ABorderCornerThatGoesIsAsFarAsItStoodOut) {
  const tests::TestMesh mesh{
      {{0, -0.5F, 0}, {1, 0, 0}, {1, 2, 0}, {-1, 2, 0}, {-1, 0, 0}, {2, 0, 0}},
      {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {1, 5, 2}}};
  FanGapMeter meter;
  const Star star{mesh, 0, 1, mesh.positions[1], std::vector<float>(4)};
  const StarMesh star_mesh(star);
  const std::optional<DiscGap> gap = measure(meter, star, star_mesh);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(expect_covers(star, star_mesh, *gap), 0.5, 1e-6);
  EXPECT_NEAR(gap->from, 0.5F, 1e-5);
  EXPECT_LE(largest_deviation(*gap), 0.75F);
}

TEST(FanGapTest, WhatIsNoDiscIsRefused) {
  FanGapMeter meter;
  const auto expect_refused = [&](const std::string& name, tests::TestMesh mesh) {
    Star star{std::move(mesh), 0, 1, {}, {}};
    star.place = (star.mesh.positions[0] + star.mesh.positions[1]) * 0.5F;
    star.deviations.resize(star.mesh.triangles.size());
    const StarMesh star_mesh(star);
    EXPECT_FALSE(measure(meter, star, star_mesh)) << name;
  };
  const tests::TestMesh disc = make_star(StarShape::closed, {"flat"}, 0, 5).mesh;
  tests::TestMesh mesh = disc;
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  expect_refused("a triangle the other way", mesh);
  mesh = disc;
  mesh.triangles.push_back(mesh.triangles[0]);
  std::ranges::rotate(mesh.triangles.back(), mesh.triangles.back().begin() + 1);
  expect_refused("a triangle twice", mesh);
  mesh = disc;
  mesh.positions.push_back({0, 0, 5});
  mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
  expect_refused("three triangles at the edge", mesh);
  mesh = disc;
  std::ranges::fill(mesh.positions, Vec3f{1, 2, 3});
  expect_refused("a point", mesh);
  mesh = disc;
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 5}, {1, 0, 5}});
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.triangles.push_back({0, last - 1, last});
  expect_refused("another sheet at an end", mesh);
  expect_refused("a triangle alone", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
}

}  // namespace
}  // namespace meshhier::cluster_simplify
