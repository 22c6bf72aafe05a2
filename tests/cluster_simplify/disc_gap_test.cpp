#include "cluster_simplify/disc_gap.h"

#include "tests/cluster_simplify/stars.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::Star;
using tests::StarMesh;
using tests::StarShape;

float largest_drift(const DiscGap& gap) {
  float most = 0;
  for (const DiscGap::Link& link : gap.links)
    most = std::max(most, link.drift);
  return most;
}

std::optional<DiscGap> measure(DiscGapMeter& meter, const Star& star, const StarMesh& mesh,
                               float enough = 0) {
  return meter.measure(star.mesh.positions, star.drifts, mesh.collapse(), enough);
}

constexpr std::uint32_t kMostVertices = 64;

TEST(DiscGapTest, NoSampleIsBeyondTheDrifts) {
  DiscGapMeter meter(kMostVertices);
  for (const tests::StarRelief& relief :
       {tests::StarRelief{"flat"}, tests::StarRelief{"bumpy", 0.2}, tests::StarRelief{"steep", 1.0},
        tests::StarRelief{"creased", 0.02, 0.7}, tests::StarRelief{"bowl", 0.05, 0, 0.3}}) {
    SCOPED_TRACE(relief.name);
    int measured = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      SCOPED_TRACE(seed);
      const Star star = make_star(StarShape::closed, relief, seed % 2 == 0 ? 0 : 0.1, seed);
      const StarMesh mesh(star);
      const std::optional<DiscGap> gap = measure(meter, star, mesh);
      if (!gap)
        continue;
      ++measured;
      expect_covers(star, mesh, *gap);
      if (testing::Test::HasFailure())
        return;
    }
    EXPECT_GT(measured, 150);  // others show a back
  }
}

TEST(DiscGapTest, IsNotLooseOnBumps) {
  DiscGapMeter meter(kMostVertices);
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Star star = make_star(StarShape::closed, {"bumpy", 0.2}, 0, seed);
    const StarMesh mesh(star);
    const std::optional<DiscGap> gap = measure(meter, star, mesh);
    if (!gap)
      continue;
    const double ratio = double{largest_drift(*gap)} / expect_covers(star, mesh, *gap);
    ASSERT_LE(ratio, 3) << seed;
    sum += ratio;
    ++count;
  }
  ASSERT_GT(count, 150);
  EXPECT_LE(sum / count, 1.5);
}

TEST(DiscGapTest, FlatGroundStaysWhereItIs) {
  DiscGapMeter meter(kMostVertices);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Star star = make_star(StarShape::closed, {"flat"}, 0, seed);
    star.place.z = 0;
    const StarMesh mesh(star);
    const std::optional<DiscGap> gap = measure(meter, star, mesh);
    if (!gap)
      continue;
    EXPECT_LE(largest_drift(*gap), 2e-5F);
    EXPECT_EQ(gap->from, 0);
    EXPECT_EQ(gap->to, 0);
  }
}

TEST(DiscGapTest, APeakThatGoesIsAsFarAsItWasHigh) {
  // A square with a peak over its middle, and the ring's normal straight up.
  const Star star{{{{0, 0, 0.25F}, {0.5F, 0, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}},
                   {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1}, {1, 5, 2}}},
                  0,
                  1,
                  {0.5F, 0, 0},
                  std::vector<float>(6)};
  DiscGapMeter meter(6);
  const StarMesh mesh(star);
  const std::optional<DiscGap> gap = measure(meter, star, mesh);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(largest_drift(*gap), 0.25F, 1e-4);
  EXPECT_NEAR(gap->from, 0.25F, 1e-4);
  EXPECT_EQ(gap->to, 0);
}

TEST(DiscGapTest, BelowEnoughDriftsMayBeLooseButNeverWrong) {
  DiscGapMeter meter(kMostVertices);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const Star star = make_star(StarShape::closed, {"bumpy", 0.2}, 0.1, seed);
    const StarMesh mesh(star);
    const std::optional<DiscGap> tight = measure(meter, star, mesh);
    if (!tight)
      continue;
    const float exact = largest_drift(*tight);
    for (const float enough : {exact / 2, exact * 1.5F, 10.0F}) {
      const std::optional<DiscGap> loose = measure(meter, star, mesh, enough);
      ASSERT_TRUE(loose);
      ASSERT_LE(largest_drift(*loose), std::max(exact, enough * 1.001F));
      expect_covers(star, mesh, *loose);
    }
  }
}

/// Stars that no direction shows as a disc.
std::vector<std::pair<std::string, Star>> others() {
  std::vector<std::pair<std::string, Star>> result;
  const auto add = [&](const std::string& name, tests::TestMesh mesh) {
    Star star{std::move(mesh), 0, 1, {}, {}};
    star.place = (star.mesh.positions[0] + star.mesh.positions[1]) * 0.5F;
    star.drifts.resize(star.mesh.triangles.size());
    result.emplace_back(name, std::move(star));
  };
  const tests::TestMesh disc = make_star(StarShape::closed, {"flat"}, 0, 5).mesh;
  tests::TestMesh mesh = disc;
  mesh.triangles.pop_back();
  add("an edge of one triangle", mesh);
  mesh = disc;
  mesh.triangles.erase(mesh.triangles.begin());
  add("a hole beside the edge", mesh);
  mesh = disc;
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  add("a triangle the other way", mesh);
  mesh = disc;
  mesh.triangles.push_back(mesh.triangles[0]);
  add("a triangle twice", mesh);
  mesh = disc;
  mesh.positions.push_back({0, 0, 5});
  mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
  add("three triangles at the edge", mesh);
  mesh = disc;
  mesh.positions[2] = {5, -5, 0};
  add("a ring folded over", mesh);
  mesh = disc;
  mesh.positions[0] = {-5, 0, 0};
  add("an end beyond its ring", mesh);
  add("a tetrahedron",
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}});
  mesh = disc;
  std::ranges::fill(mesh.positions, Vec3f{1, 2, 3});
  add("a point", mesh);
  mesh = disc;
  for (Vec3f& p : mesh.positions)
    p.y = p.z = 0;
  add("a line", mesh);
  add("too many triangles", [] {
    tests::TestMesh wheel = tests::wheel(40, 0.3F);
    std::swap(wheel.triangles[0], wheel.triangles[1]);
    return wheel;
  }());
  return result;
}

TEST(DiscGapTest, WhatIsNoDiscIsRefusedAndForgotten) {
  DiscGapMeter meter(kMostVertices);
  const Star plain = make_star(StarShape::closed, {"bumpy", 0.2}, 0, 7);
  const StarMesh plain_mesh(plain);
  const std::optional<DiscGap> first = measure(meter, plain, plain_mesh);
  ASSERT_TRUE(first);
  const float expected = largest_drift(*first);
  for (const auto& [name, star] : others()) {
    SCOPED_TRACE(name);
    const StarMesh mesh(star);
    EXPECT_FALSE(measure(meter, star, mesh));
    const std::optional<DiscGap> again = measure(meter, plain, plain_mesh);
    ASSERT_TRUE(again);
    EXPECT_EQ(largest_drift(*again), expected);
  }
}

TEST(DiscGapTest, OpenBordersAreRefused) {
  DiscGapMeter meter(kMostVertices);
  for (const StarShape shape : {StarShape::border_edge, StarShape::border_end}) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Star star = make_star(shape, {"flat"}, 0, seed);
      const StarMesh mesh(star);
      EXPECT_FALSE(measure(meter, star, mesh));
    }
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
