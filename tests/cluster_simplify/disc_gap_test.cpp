#include "cluster_simplify/disc_gap.h"

#include "tests/cluster_simplify/stars.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::largest_deviation;
using tests::Star;
using tests::StarMesh;
using tests::StarShape;

/// Nothing of what is no disc, which a meter need not be asked.
std::optional<DiscGap> measure(DiscGapMeter& meter, const Star& star, const StarMesh& mesh,
                               float enough = 0) {
  if (!mesh.edge_star().is_disc())
    return std::nullopt;
  return meter.measure(star.mesh.positions, star.deviations, mesh.edge_star(), star.place, enough);
}

TEST(DiscGapTest, NoSampleIsBeyondTheDeviations) {
  DiscGapMeter meter;
  for (const tests::StarRelief& relief :
       {tests::StarRelief{"flat"}, tests::StarRelief{"bumpy", 0.2}, tests::StarRelief{"steep", 1.0},
        tests::StarRelief{"creased", 0.02, 0.7}, tests::StarRelief{"bowl", 0.05, 0, 0.3}}) {
    const int measured = expect_all_covered(
        StarShape::closed, relief, 300,
        [&](const Star& star, const StarMesh& mesh) { return measure(meter, star, mesh); });
    ASSERT_GT(measured, 150) << relief.name;  // others show a back
  }
}

TEST(DiscGapTest, IsNotLooseOnBumps) {
  DiscGapMeter meter;
  const tests::Looseness looseness = looseness_of(
      StarShape::closed, {"bumpy", 0.2}, 300,
      [&](const Star& star, const StarMesh& mesh) { return measure(meter, star, mesh); });
  EXPECT_GT(looseness.stars, 150);
  EXPECT_LE(looseness.largest, 3);
  EXPECT_LE(looseness.mean, 1.5);
}

TEST(DiscGapTest, FlatGroundStaysWhereItIs) {
  DiscGapMeter meter;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Star star = make_star(StarShape::closed, {"flat"}, 0, seed);
    star.place.z = 0;
    const StarMesh mesh(star);
    const std::optional<DiscGap> gap = measure(meter, star, mesh);
    if (!gap)
      continue;
    EXPECT_LE(largest_deviation(*gap), 2e-5F);
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
  DiscGapMeter meter;
  const StarMesh mesh(star);
  const std::optional<DiscGap> gap = measure(meter, star, mesh);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(largest_deviation(*gap), 0.25F, 1e-4);
  EXPECT_NEAR(gap->from, 0.25F, 1e-4);
  EXPECT_EQ(gap->to, 0);
}

TEST(DiscGapTest, BelowEnoughDeviationsMayBeLooseButNeverWrong) {
  DiscGapMeter meter;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const Star star = make_star(StarShape::closed, {"bumpy", 0.2}, 0.1, seed);
    const StarMesh mesh(star);
    const std::optional<DiscGap> tight = measure(meter, star, mesh);
    if (!tight)
      continue;
    const float exact = largest_deviation(*tight);
    for (const float enough : {exact / 2, exact * 1.5F, 10.0F}) {
      const std::optional<DiscGap> loose = measure(meter, star, mesh, enough);
      ASSERT_TRUE(loose);
      ASSERT_LE(largest_deviation(*loose), std::max(exact, enough * 1.001F));
      expect_covers(star, mesh, *loose);
    }
  }
}

struct Refused {
  std::string name;
  Star star;
  bool is_disc = false;  ///< but no direction shows it as one
};

std::vector<Refused> refused() {
  std::vector<Refused> result;
  const auto add = [&](const std::string& name, tests::TestMesh mesh, bool is_disc) {
    Star star{std::move(mesh), 0, 1, {}, {}};
    star.place = (star.mesh.positions[0] + star.mesh.positions[1]) * 0.5F;
    star.deviations.resize(star.mesh.triangles.size());
    result.push_back({name, std::move(star), is_disc});
  };
  const tests::TestMesh disc = make_star(StarShape::closed, {"flat"}, 0, 5).mesh;
  tests::TestMesh mesh = disc;
  mesh.triangles.pop_back();
  add("an edge of one triangle", mesh, false);
  mesh = disc;
  mesh.triangles.erase(mesh.triangles.begin());
  add("a hole beside the edge", mesh, false);
  mesh = disc;
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  add("a triangle the other way", mesh, false);
  mesh = disc;
  mesh.triangles.push_back(mesh.triangles[0]);
  add("a triangle twice", mesh, false);
  mesh = disc;
  mesh.positions.push_back({0, 0, 5});
  mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
  add("three triangles at the edge", mesh, false);
  add("a tetrahedron",
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}},
      false);
  mesh = tests::wheel(40, 0.3F);
  std::swap(mesh.triangles[0], mesh.triangles[1]);
  add("too many triangles", mesh, false);
  mesh = disc;
  mesh.positions[2] = {5, -5, 0};
  add("a ring folded over", mesh, true);
  mesh = disc;
  mesh.positions[0] = {-5, 0, 0};
  add("an end beyond its ring", mesh, true);
  mesh = disc;
  std::ranges::fill(mesh.positions, Vec3f{1, 2, 3});
  add("a point", mesh, true);
  mesh = disc;
  for (Vec3f& p : mesh.positions)
    p.y = p.z = 0;
  add("a line", mesh, true);
  return result;
}

TEST(DiscGapTest, WhatShowsNoDiscIsRefusedAndForgotten) {
  DiscGapMeter meter;
  const Star plain = make_star(StarShape::closed, {"bumpy", 0.2}, 0, 7);
  const StarMesh plain_mesh(plain);
  const std::optional<DiscGap> first = measure(meter, plain, plain_mesh);
  ASSERT_TRUE(first);
  const float expected = largest_deviation(*first);
  for (const auto& [name, star, is_disc] : refused()) {
    SCOPED_TRACE(name);
    const StarMesh mesh(star);
    EXPECT_EQ(mesh.edge_star().is_disc(), is_disc);
    EXPECT_FALSE(measure(meter, star, mesh));
    const std::optional<DiscGap> again = measure(meter, plain, plain_mesh);
    ASSERT_TRUE(again);
    EXPECT_EQ(largest_deviation(*again), expected);
  }
}

TEST(DiscGapTest, StarsOnOpenBordersAreNoDiscs) {
  for (const StarShape shape : {StarShape::border_edge, StarShape::border_end}) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Star star = make_star(shape, {"flat"}, 0, seed);
      EXPECT_FALSE(StarMesh(star).edge_star().is_disc());
    }
  }
}

// Four links at a time, of two ends: whichever are the last of either.
TEST(DiscGapTest, OnRingsOfAnySizeNoSampleIsBeyondTheDeviations) {
  DiscGapMeter meter;
  for (std::uint32_t size = 4; size <= 28; ++size) {
    for (const std::uint32_t turn : {1U, size / 3, size / 2, size - 1}) {
      SCOPED_TRACE(std::to_string(size) + " " + std::to_string(turn));
      const Star star = tests::round_star({size, turn}, {"bumpy", 0.2}, size);
      const StarMesh mesh(star);
      ASSERT_TRUE(mesh.edge_star().is_disc());
      const std::optional<DiscGap> gap = measure(meter, star, mesh);
      ASSERT_TRUE(gap);
      EXPECT_EQ(gap->triangles.size(), size);
      expect_covers(star, mesh, *gap);
    }
  }
}

TEST(DiscGapTest, WhatIsBeyondAllNumbersIsRefused) {
  DiscGapMeter meter;
  const Star plain = make_star(StarShape::closed, {"bumpy", 0.2}, 0, 7);
  for (std::size_t t = 0; t < plain.deviations.size(); ++t) {
    Star star = plain;
    star.deviations[t] = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(measure(meter, star, StarMesh(star))) << "triangle " << t;
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
