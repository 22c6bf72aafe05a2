#include "cluster_simplify/collapse_costs.h"

#include "tests/cluster_simplify/stars.h"
#include "tests/cluster_simplify/test_tiles.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::Star;
using tests::StarMesh;
using tests::StarShape;

bool keeps(const StarMesh& mesh, const Star& star) {
  return keeps_sides(star.mesh.positions, mesh.edge_star(), star.place);
}

/// The same star with one more triangle at an end, without area: no disc.
Star no_disc(Star star) {
  const tests::MeshTriangle extra = {star.from, tests::count_of(star.mesh.positions),
                                     tests::count_of(star.mesh.positions) + 1};
  star.mesh.positions.resize(star.mesh.positions.size() + 2, star.mesh.positions[star.from]);
  star.mesh.triangles.push_back(extra);
  star.deviations.push_back(0);
  return star;
}

/// As a disc, and like anything else.
void expect_keeps(const Star& star, bool expected) {
  const StarMesh disc(star);
  ASSERT_TRUE(disc.edge_star().is_disc());
  EXPECT_EQ(keeps(disc, star), expected);
  const Star other = no_disc(star);
  const StarMesh mesh(other);
  ASSERT_FALSE(mesh.edge_star().is_disc());
  EXPECT_EQ(keeps(mesh, other), expected) << "no disc";
}

/// Which triangles turn by more than an angle of this cosine.
std::vector<std::uint32_t> turning(const Star& star, double cosine) {
  const StarMesh mesh(star);
  const auto before = mesh.before();
  const auto after = mesh.after();
  const auto normal = [](const tests::Corners& t) { return cross(t[1] - t[0], t[2] - t[0]); };
  std::vector<std::uint32_t> result;
  for (std::uint32_t t = 0; t < before.size(); ++t) {
    if (!mesh.survives(t))
      continue;
    const Vec3d a = normal(before[t]);
    const Vec3d b = normal(after[t]);
    if (dot(a, b) < cosine * length(a) * length(b))
      result.push_back(t);
  }
  return result;
}

constexpr double kLimit = 0.2;      // about 78 degrees
constexpr double kDoubtful = 1e-4;  // cosines so near each other may be told either way by rounding

bool is_doubtful(const Star& star) {
  return turning(star, kLimit - kDoubtful) != turning(star, kLimit + kDoubtful);
}

/// Half of the places are somewhere else: there triangles turn.
Star random_star(StarShape shape, const tests::StarRelief& relief, std::uint64_t seed) {
  Star star = make_star(shape, relief, 0, seed);
  const auto any = [&](std::uint64_t axis) { return tests::hash_noise(seed, axis); };
  if (seed % 2 == 0)
    star.place = star.place + Vec3f{any(1), any(2), any(3)} * 2.0F;
  return star;
}

const std::array kReliefs = {
    tests::StarRelief{"flat"}, tests::StarRelief{"bumpy", 0.2}, tests::StarRelief{"steep", 1.0},
    tests::StarRelief{"creased", 0.02, 1.5}, tests::StarRelief{"bowl", 0.05, 0, 1}};

TEST(KeepsSidesTest, IsTheDefinitionOnDiscsAndOnTheSameStarsAsNoDiscs) {
  std::array<int, 2> met{};
  int alone = 0;
  for (const tests::StarRelief& relief : kReliefs) {
    SCOPED_TRACE(relief.name);
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
      SCOPED_TRACE(seed);
      const Star star = random_star(StarShape::closed, relief, seed);
      if (is_doubtful(star))
        continue;
      const std::size_t turned = turning(star, kLimit).size();
      expect_keeps(star, turned == 0);
      ++met[turned == 0 ? 1 : 0];
      alone += turned == 1 ? 1 : 0;
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GT(met[0], 1000);
  EXPECT_GT(met[1], 1000);
  EXPECT_GT(alone, 300);
}

TEST(KeepsSidesTest, IsTheDefinitionOnBorders) {
  std::array<int, 2> met{};
  for (const tests::StarRelief& relief : kReliefs) {
    SCOPED_TRACE(relief.name);
    for (const StarShape shape : {StarShape::border_edge, StarShape::border_end}) {
      for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const Star star = random_star(shape, relief, seed);
        if (is_doubtful(star))
          continue;
        const bool expected = turning(star, kLimit).empty();
        const StarMesh mesh(star);
        ASSERT_FALSE(mesh.edge_star().is_disc());
        ASSERT_EQ(keeps(mesh, star), expected) << seed;
        ++met[expected ? 1 : 0];
      }
    }
  }
  EXPECT_GT(met[0], 300);
  EXPECT_GT(met[1], 300);
}

/// The middle of ring vertices i and i + 1, times a factor.
Vec3f beside_link(const Star& star, std::uint32_t ring_size, std::uint32_t i, float factor) {
  const auto& p = star.mesh.positions;
  return (p[2 + i] + p[2 + (i + 1) % ring_size]) * (factor / 2);
}

TEST(KeepsSidesTest, BeyondAnyLinkOfAFlatRingItsTriangleTurns) {
  for (std::uint32_t size = 4; size <= 28; ++size) {
    for (const std::uint32_t from_links : {1U, 2U, size / 2, size - 1}) {
      SCOPED_TRACE(std::to_string(size) + " " + std::to_string(from_links));
      Star star = tests::round_star({size, from_links}, {"flat"}, size);
      expect_keeps(star, true);
      for (std::uint32_t i = 0; i < size; ++i) {
        star.place = beside_link(star, size, i, 0.98F);
        expect_keeps(star, true);
        star.place = beside_link(star, size, i, 1.02F);
        ASSERT_EQ(turning(star, kLimit).size(), 1U);
        expect_keeps(star, false);
      }
    }
  }
}

TEST(KeepsSidesTest, AboveFlatGroundTrianglesTurnAsTheyRise) {
  // The place at a height over the middle of a square: its triangles turn by the slope's angle.
  Star star = tests::round_star({4, 2}, {"flat"}, 1);
  const double reach = 2 * std::cos(std::numbers::pi / 4);
  for (const double degrees : {0.0, 45.0, 77.0, 78.0, 79.0, 85.0}) {
    star.place = tests::vec3f(0, 0, reach * std::tan(degrees / 180 * std::numbers::pi));
    expect_keeps(star, degrees < 78.4);
  }
}

TEST(KeepsSidesTest, ATriangleWithoutAreaHasNoSideToKeep) {
  for (const std::uint32_t vertex : {2U, 4U, 6U}) {
    Star star = tests::round_star({8, 3}, {"flat"}, 3);
    star.mesh.positions[vertex] = star.mesh.positions[vertex + 1];
    expect_keeps(star, true);
  }
  // The first link of vertex 0 lies on a line with it, and shows its back to the place.
  Star star = tests::round_star({8, 3}, {"flat"}, 3);
  star.place = {0.125F, 0.0625F, 0};
  star.mesh.positions[0] = {0.5F, 0, 0};
  star.mesh.positions[2] = {1, -1, 0};
  star.mesh.positions[3] = {1.5F, -2, 0};
  expect_keeps(star, true);
}

TEST(KeepsSidesTest, ATriangleThatLosesItsAreaTurns) {
  Star star = tests::round_star({8, 3}, {"flat"}, 3);
  for (std::uint32_t vertex = 2; vertex < 10; ++vertex) {
    star.place = star.mesh.positions[vertex];
    expect_keeps(star, false);
  }
}

TEST(KeepsSidesTest, TrianglesAtTheEdgeMayTurn) {
  Star star = tests::round_star({8, 4}, {"flat"}, 3);
  const Vec3f from = star.mesh.positions[star.from];
  const Vec3f to = star.mesh.positions[star.to];
  for (const float part : {-0.5F, 0.0F, 1.0F, 1.5F}) {  // at the ends, and past them
    star.place = from + (to - from) * part;
    expect_keeps(star, true);
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
