#include "cluster_simplify/deviation_meter.h"

#include "tests/cluster_simplify/collapsing.h"
#include "tests/cluster_simplify/sampling.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::Collapsing;
using tests::Corners;
using tests::distance_to_surface;
using tests::distance_to_triangle;
using tests::farthest_sample;
using tests::samples_of;
using tests::surface_of;

constexpr int kDeviationMeterSteps = 4;
constexpr double kDeviationMeterSlack = 1e-6;  // rounding of places in single precision near one

/// Closed, open, folded, with pieces that meet in edges and points, without area.
std::vector<tests::NamedMesh> metered_meshes() {
  tests::TestMesh spiky = tests::sphere(200);
  for (std::uint32_t v = 0; v < spiky.positions.size(); v += 5)
    spiky.positions[v] = spiky.positions[v] * 1.6F;
  tests::TestMesh line = tests::open_grid(8, 3);
  for (Vec3f& p : line.positions)
    p.y = p.z = 0;
  return {{"sphere", tests::sphere(200, 0.05F)},
          {"torus", tests::torus(200, 0.05F)},
          {"spiky", spiky},
          {"flat grid", tests::open_grid(9, 9)},
          {"grid", tests::open_grid(9, 9, 0.3F)},
          {"strip", tests::open_grid(30, 1, 0.2F)},
          {"moebius", tests::moebius(150)},
          {"non-manifold", tests::non_manifold(200, 0.05F)},
          {"mirrored", tests::mirrored(tests::sphere(100, 0.05F))},
          {"duplicates", tests::duplicates(200, 0.05F)},
          {"tangle", tests::tangle(30, 100, 3)},
          {"without area", line},
          {"hub", tests::wheel(60, 0.3F)},
          {"large hub", tests::wheel(300, 0.3F)}};
}

/// Collapses any edges to any places nearby until so many vertices have gone, or none can.
class RandomCollapses {
 public:
  RandomCollapses(Collapsing& tile, std::uint64_t seed, bool vanishing)
      : tile_(tile), seed_(seed), vanishing_(vanishing) {}

  void run(std::uint32_t count) {
    for (std::uint32_t tries = 0; count > 0 && tries < 40 * count + 1000; ++tries) {
      const auto e = below(static_cast<std::uint32_t>(tile_.mesh().edges().size()));
      const CollapseMesh::Edge edge = tile_.mesh().edge(e);
      if (edge.triangle_count == 0 || !tile_.mesh().is_own_edge(e) ||
          (!vanishing_ && would_vanish(edge)))
        continue;
      collapse(edge);
      --count;
    }
  }

 private:
  double chance() { return (double{tests::hash_noise(asked_++, seed_)} + 1) / 2; }
  std::uint32_t below(std::uint32_t count) {
    return std::min(count - 1, static_cast<std::uint32_t>(chance() * count));
  }

  /// No triangle would be left at the edge.
  bool would_vanish(const CollapseMesh::Edge& edge) {
    std::vector<CollapseMesh::Fan> fans;
    std::size_t left = 0;
    for (const auto& [v, other] : {std::pair{edge.a, edge.b}, std::pair{edge.b, edge.a}}) {
      tile_.mesh().gather(v, fans);
      left += static_cast<std::size_t>(std::ranges::count_if(
          fans, [&](const auto& fan) { return fan.next != other && fan.previous != other; }));
    }
    return left == 0;
  }

  void collapse(const CollapseMesh::Edge& edge) {
    const Vec3f a = tile_.places()[edge.a];
    const Vec3f b = tile_.places()[edge.b];
    switch (below(4)) {
      case 0:
        tile_.collapse(edge.a, edge.b);
        break;
      case 1:
        tile_.collapse(edge.b, edge.a);
        break;
      case 2:
        tile_.collapse(edge.a, edge.b, (a + b) * 0.5F);
        break;
      default: {
        const auto any = [&] { return 0.3 * (chance() - 0.5) * double{length(b - a)}; };
        tile_.collapse(edge.a, edge.b, (a + b) * 0.5F + tests::vec3f(any(), any(), any()));
      }
    }
  }

  Collapsing& tile_;
  std::uint64_t seed_;
  bool vanishing_;
  std::uint64_t asked_ = 0;
};

struct Surface {
  std::vector<Corners> triangles;
  std::vector<double> deviations;
};

Surface living(Collapsing& tile) {
  Surface surface;
  const auto faces = tile.mesh().faces();
  for (std::uint32_t t = 0; t < faces.size(); ++t) {
    if (!faces[t].is_alive())
      continue;
    Corners& corners = surface.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = to_double(tile.places()[faces[t].corners[k]]);
    surface.deviations.push_back(double{tile.deviation().of_triangle(t)});
  }
  return surface;
}

std::vector<Corners> local_surface(const Collapsing& tile, const tests::TestMesh& mesh) {
  return surface_of(tests::TestMesh{tile.frame().to_local(mesh.positions), mesh.triangles});
}

/// No point of a triangle is farther from what was there at first than its deviation.
void expect_near_the_original(const Surface& now, const std::vector<Corners>& original) {
  for (std::size_t t = 0; t < now.triangles.size(); ++t) {
    for (const Vec3d p : samples_of(now.triangles[t], kDeviationMeterSteps))
      ASSERT_LE(distance_to_surface(p, original), now.deviations[t] + kDeviationMeterSlack)
          << "triangle " << t;
  }
}

/// Every point of what was there at first is within the deviation of some triangle.
void expect_original_covered(const Surface& now, const std::vector<Corners>& original) {
  for (const Corners& corners : original) {
    for (const Vec3d p : samples_of(corners, kDeviationMeterSteps)) {
      double missing = std::numeric_limits<double>::infinity();
      for (std::size_t t = 0; t < now.triangles.size(); ++t)
        missing = std::min(missing, distance_to_triangle(p, now.triangles[t]) - now.deviations[t]);
      ASSERT_LE(missing, kDeviationMeterSlack);
    }
  }
}

TEST(DeviationMeterTest, DeviationsOfManyCollapsesHoldBothWays) {
  for (const auto& [name, mesh] : metered_meshes()) {
    const BuildTile input = tests::tile_of(mesh);
    for (const double part : {0.1, 0.5, 0.8}) {
      for (std::uint64_t seed = 0; seed < 3; ++seed) {
        SCOPED_TRACE(name + " " + std::to_string(part) + " " + std::to_string(seed));
        Collapsing tile(input);
        RandomCollapses(tile, seed, false)
            .run(static_cast<std::uint32_t>(part * input.mesh.own_count));
        const Surface now = living(tile);
        const std::vector<Corners> original = local_surface(tile, mesh);
        expect_near_the_original(now, original);
        expect_original_covered(now, original);
        if (testing::Test::HasFailure())
          return;
      }
    }
  }
}

TEST(DeviationMeterTest, GhostsStayAndTheirTrianglesDeviation) {
  for (const auto& [name, mesh] : metered_meshes()) {
    SCOPED_TRACE(name);
    const BuildTile input = tests::part_of(mesh, 0.1F);
    if (input.mesh.interior.empty())
      continue;
    Collapsing tile(input);
    const std::vector<Vec3f> before = tile.places();
    tests::TestMesh local{before, {}};
    for (const auto* triangles : {&input.mesh.interior, &input.mesh.border}) {
      for (const TileTriangle& t : *triangles)
        local.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
    }
    RandomCollapses(tile, 5, false).run(input.mesh.own_count / 2);
    const Surface now = living(tile);
    expect_near_the_original(now, surface_of(local));
    expect_original_covered(now, surface_of(local));
  }
}

TEST(DeviationMeterTest, IsNotLooseAfterManyCollapses) {
  for (const auto& mesh : {tests::sphere(500, 0.01F), tests::torus(500, 0.01F)}) {
    const BuildTile input = tests::tile_of(mesh);
    Collapsing tile(input);
    RandomCollapses(tile, 3, false).run(input.mesh.own_count / 3);
    const Surface now = living(tile);
    const std::vector<Corners> original = local_surface(tile, mesh);
    const double sampled = std::max(farthest_sample(now.triangles, original, kDeviationMeterSteps),
                                    farthest_sample(original, now.triangles, kDeviationMeterSteps));
    EXPECT_LE(*std::ranges::max_element(now.deviations), 4 * sampled);
  }
}

TEST(DeviationMeterTest, NothingDeviationsBeforeTheFirstCollapse) {
  const BuildTile input = tests::tile_of(tests::sphere(200, 0.05F));
  Collapsing tile(input);
  for (const double deviation : living(tile).deviations)
    EXPECT_EQ(deviation, 0);
  EXPECT_EQ(tile.deviation().squared_sum(), 0);
}

TEST(DeviationMeterTest, SquaresAreWeightedDistancesOfBothEnds) {
  // A peak of weight 3 goes, half its height above the plane of its square.
  tests::TestMesh mesh = tests::open_grid(3, 2);
  const std::uint32_t peak = 5;
  mesh.positions[peak].z = 0.5F;
  BuildTile input = tests::tile_of(mesh);
  input.history.weights[peak] = 3;
  Collapsing tile(input);
  tile.collapse(peak, peak + 1);
  const double height = 0.5 / tile.frame().to_global(1.0);
  EXPECT_NEAR(tile.deviation().squared_sum(), 3 * height * height, 0.1 * height * height);
}

TEST(DeviationMeterTest, WeightsGoWithTheirVertices) {
  BuildTile input = tests::tile_of(tests::open_grid(4, 2));
  Collapsing tile(input);
  const double unit = 1 / tile.frame().to_global(1.0);
  tile.collapse(6, 7, tile.places()[7]);
  EXPECT_LE(tile.deviation().squared_sum(), 1e-9);
  const Vec3f up{0, 0, static_cast<float>(unit)};
  tile.collapse(7, 8, tile.places()[7] + up);  // two vertices went up one
  EXPECT_GE(tile.deviation().squared_sum(), 0.3 * unit * unit);
  EXPECT_LE(tile.deviation().squared_sum(), 3.1 * unit * unit);
}

/// Sheets on each other, one of which has deviated: what lay on both lies on the one that is left.
TEST(DeviationMeterTest, WhatLandsExactlyBringsItsDeviation) {
  // Two sheets from the edge 0-1 to 2; on the one 3 has gone up and down again.
  tests::TestMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5F, 0.5F, 0.5F}, {1, 1, 0}, {2, 0, 0}},
                       {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 5, 4}}};
  const BuildTile input = tests::tile_of(mesh);
  Collapsing tile(input);
  const std::vector<Corners> original = local_surface(tile, mesh);
  tile.collapse(3, 0);
  tile.collapse(1, 5);
  const Surface now = living(tile);
  expect_near_the_original(now, original);
  expect_original_covered(now, original);
}

TEST(DeviationMeterTest, OfAllThatCollapsedNothingIsLeftUnseen) {
  // Pieces vanish: what is left, the deviations and what was lost cover the original together.
  for (const auto& [name, mesh] : metered_meshes()) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE(name + " " + std::to_string(seed));
      const BuildTile input = tests::tile_of(mesh);
      Collapsing tile(input);
      RandomCollapses(tile, seed, true).run(input.mesh.own_count * 9 / 10);
      std::uint32_t left = 0;
      for (std::uint32_t v = 0; v < input.mesh.own_count; ++v)
        left += tile.mesh().representative(v) == v && !tile.mesh().is_isolated(v) ? 1 : 0;
      if (left == 0)
        continue;
      const Contraction chosen = tile.choose(left);
      double bound = std::max(double{chosen.deviation.interior}, double{chosen.deviation.lost});
      for (const float deviation : chosen.deviation.around)
        bound = std::max(bound, double{deviation});
      const std::vector<Corners> image = surface_of(tests::image_of(input, chosen));
      const double size = tile.frame().to_global(1.0);
      EXPECT_LE(farthest_sample(surface_of(mesh), image, kDeviationMeterSteps),
                bound + kDeviationMeterSlack * size);
    }
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify
