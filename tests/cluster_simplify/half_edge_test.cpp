#include "cluster_simplify/half_edge.h"

#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {

static void PrintTo(HalfEdgeCost cost, std::ostream* out) {
  *out << (cost == HalfEdgeCost::quadric ? "quadric" : "melax");
}

namespace {

using testing::Each;
using tests::MeshTriangle;
using tests::TestMesh;

bool same_bits(Vec3f a, Vec3f b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Every representative is one of the vertices that it stands for, position and attributes.
void expect_subset(const BuildTile& tile, const Contraction& found) {
  const VertexArray& vertices = tile.mesh.vertices;
  const VertexArray& chosen = found.representatives;
  std::vector<bool> met(chosen.size());
  for (std::uint32_t v = 0; v < tile.mesh.own_count; ++v) {
    const std::uint32_t parent = found.parent_of[v];
    met[parent] = met[parent] ||
                  (same_bits(vertices.positions[v], chosen.positions[parent]) &&
                   std::ranges::equal(vertices.attributes_of(v), chosen.attributes_of(parent)));
  }
  EXPECT_THAT(met, Each(true));
}

/// The same checks for both costs.
class HalfEdgeTest : public testing::TestWithParam<HalfEdgeCost> {
 protected:
  Contraction contracted(const BuildTile& tile, std::uint32_t target) const {
    return half_edge(tile, target, GetParam());
  }
};

INSTANTIATE_TEST_SUITE_P(Costs, HalfEdgeTest,
                         testing::Values(HalfEdgeCost::quadric, HalfEdgeCost::melax),
                         [](const auto& cost) { return testing::PrintToString(cost.param); });

TEST_P(HalfEdgeTest, EveryRepresentativeIsAVertexThatStandsForItself) {
  for (const auto& [name, mesh] : tests::nasty_meshes()) {
    SCOPED_TRACE(name);
    for (BuildTile tile : {tests::tile_of(mesh), tests::part_of(mesh, 0.3F)}) {
      if (tile.mesh.own_count == 0)
        continue;
      tests::add_attributes(tile);
      for (const std::uint32_t part : {1U, 2U, 4U, 9U, 1000U}) {
        const std::uint32_t target = std::max(1U, tile.mesh.own_count / part);
        const Contraction found = contracted(tile, target);
        ASSERT_EQ(found.representatives.size(), target);
        expect_subset(tile, found);
      }
    }
  }
}

TEST_P(HalfEdgeTest, RepresentativesAreInTheOrderOfTheirVertices) {
  const BuildTile tile = tests::tile_of(tests::sphere(2000, 0.03F));
  const Contraction found = contracted(tile, 200);
  auto place = tile.mesh.vertices.positions.begin();
  for (const Vec3f p : found.representatives.positions) {
    place = std::find(place, tile.mesh.vertices.positions.end(), p);
    ASSERT_NE(place, tile.mesh.vertices.positions.end());
  }
}

TEST_P(HalfEdgeTest, ACubeIsDownToItsCorners) {
  for (const std::uint32_t target : {50U, 12U, 8U}) {
    const BuildTile tile = tests::tile_of(tests::cube(16));
    const Contraction found = contracted(tile, target);
    EXPECT_THAT(found.representatives.positions, testing::IsSupersetOf(tests::cube_corners()));
    const TestMesh image = tests::image_of(tile, found);
    EXPECT_TRUE(tests::is_closed(image.triangles));
    EXPECT_EQ(found.fallbacks.torn + found.fallbacks.without_care(), 0U);
    double volume = 0;
    for (const MeshTriangle& t : image.triangles) {
      volume += dot(tests::doubled_normal(image, t), to_double(image.positions[t[0]])) / 6;
    }
    EXPECT_NEAR(volume, 8, 1e-9);
  }
}

TEST_P(HalfEdgeTest, AFlatGridKeepsItsOutline) {
  for (const std::uint32_t target : {300U, 30U, 4U}) {
    const BuildTile tile = tests::tile_of(tests::open_grid(24, 24));
    const Contraction found = contracted(tile, target);
    EXPECT_THAT(found.representatives.positions,
                testing::IsSupersetOf(
                    {Vec3f{0, 0, 0}, Vec3f{24, 0, 0}, Vec3f{0, 24, 0}, Vec3f{24, 24, 0}}));
    const TestMesh image = tests::image_of(tile, found);
    double area = 0;
    for (const MeshTriangle& t : image.triangles) {
      area += tests::doubled_normal(image, t).z / 2;
      EXPECT_GE(tests::doubled_normal(image, t).z, 0);
    }
    EXPECT_NEAR(area, 24 * 24, 1e-9);
    EXPECT_EQ(tests::border_line_count(image.triangles), 1U);
  }
}

TEST_P(HalfEdgeTest, ARoofIsDownToItsRidge) {
  TestMesh roof = tests::open_grid(24, 10);
  for (Vec3f& p : roof.positions)
    p.z = -std::abs(p.x - 12);
  for (const std::uint32_t target : {60U, 6U}) {
    const Contraction found = contracted(tests::tile_of(roof), target);
    EXPECT_THAT(found.representatives.positions,
                testing::IsSupersetOf({Vec3f{0, 0, -12}, Vec3f{12, 0, 0}, Vec3f{24, 0, -12},
                                       Vec3f{0, 10, -12}, Vec3f{12, 10, 0}, Vec3f{24, 10, -12}}));
  }
}

TEST_P(HalfEdgeTest, ASphereStaysRoundAndOutward) {
  const BuildTile tile = tests::tile_of(tests::sphere(16'384));
  for (const std::uint32_t target : {2000U, 500U, 100U}) {
    const Contraction found = contracted(tile, target);
    EXPECT_EQ(found.fallbacks.torn + found.fallbacks.without_care(), 0U);
    const TestMesh image = tests::image_of(tile, found);
    EXPECT_TRUE(tests::is_closed(image.triangles));
    EXPECT_EQ(tests::euler_characteristic(image.triangles), 2);
    // Vertices on the sphere, equilateral triangles of area 2 pi / target: L^2 = 4 / sqrt(3) times
    // that, L^2 / 6 below the sphere in the middle; four times that for uneven ones.
    const double depth = 4 / std::numbers::sqrt3 * 2 * std::numbers::pi / target / 6;
    for (const MeshTriangle& t : image.triangles) {
      const Vec3d centre = (to_double(image.positions[t[0]]) + to_double(image.positions[t[1]]) +
                            to_double(image.positions[t[2]])) *
                           (1.0 / 3);
      EXPECT_GT(length(centre), 1 - 4 * depth);
      EXPECT_GT(dot(tests::doubled_normal(image, t), centre), 0);
    }
  }
}

TEST_P(HalfEdgeTest, ATorusStaysATorus) {
  const BuildTile tile = tests::tile_of(tests::torus(9600, 0.003F));
  const Contraction found = contracted(tile, 300);
  const TestMesh image = tests::image_of(tile, found);
  EXPECT_EQ(found.fallbacks.torn + found.fallbacks.without_care(), 0U);
  EXPECT_TRUE(tests::is_closed(image.triangles));
  EXPECT_EQ(tests::euler_characteristic(image.triangles), 0);
}

TEST_P(HalfEdgeTest, OpenBordersSurvive) {
  const TestMesh mesh = tests::moebius(4096);
  const BuildTile tile = tests::tile_of(mesh);
  const TestMesh image = tests::image_of(tile, contracted(tile, 100));
  const auto border_length = [](const TestMesh& m) {
    double sum = 0;
    for (const tests::Edge& e : tests::boundary_edges(m.triangles))
      sum += tests::distance(m.positions[e[0]], m.positions[e[1]]);
    return sum;
  };
  EXPECT_EQ(tests::border_line_count(image.triangles), 1U);
  EXPECT_NEAR(border_length(image), border_length(mesh), 0.02 * border_length(mesh));
}

TEST_P(HalfEdgeTest, GhostsStayAndNoGapOpensToThem) {
  const BuildTile tile = tests::part_of(tests::sphere(8192), 0.3F);
  const TestMesh image = tests::image_of(tile, contracted(tile, 200));
  for (const tests::Edge& e : tests::boundary_edges(image.triangles))
    EXPECT_TRUE(e[0] >= 200 && e[1] >= 200) << e[0] << "-" << e[1];
}

TEST_P(HalfEdgeTest, TheLevelsOfAChainAreSubsets) {
  // Level upon level: what stands at the top is a vertex of the bottom, bit for bit.
  const TestMesh mesh = tests::torus(3000, 0.02F);
  BuildTile tile = tests::tile_of(mesh);
  for (std::uint32_t target = tile.mesh.own_count / 2; target >= 50; target /= 2) {
    const TestMesh image = tests::image_of(tile, contracted(tile, target));
    tile = tests::tile_of(image);
  }
  for (const Vec3f p : tile.mesh.vertices.positions)
    EXPECT_TRUE(std::ranges::any_of(mesh.positions, [&](Vec3f q) { return same_bits(p, q); }));
}

TEST_P(HalfEdgeTest, TrianglesTurnOverWhereNoVertexSeesTheWholeRing) {
  const Contraction found = contracted(tests::tile_of(tests::z_ring(), 2), 1);
  EXPECT_EQ(found.fallbacks.turned, 1U);
  EXPECT_EQ(found.fallbacks.torn + found.fallbacks.forced + found.fallbacks.joined, 0U);
}

TEST_P(HalfEdgeTest, SoupVanishesAndStragglersAreJoined) {
  const Contraction torn = contracted(tests::tile_of(tests::soup(50)), 30);
  EXPECT_EQ(torn.fallbacks.torn, 40U);
  EXPECT_EQ(torn.fallbacks.forced + torn.fallbacks.turned + torn.fallbacks.joined, 0U);

  TestMesh tied = tests::points(30);
  tied.positions.insert(tied.positions.end(), {{3, 0, 0}, {3, 1, 0}});
  for (std::uint32_t v = 0; v < 30; ++v)
    tied.triangles.push_back({v, 30, 31});
  const Contraction joined = contracted(tests::tile_of(tied, 30), 7);
  EXPECT_EQ(joined.fallbacks.joined, 23U);
  EXPECT_EQ(joined.fallbacks.torn + joined.fallbacks.turned + joined.fallbacks.forced, 0U);
}

TEST_P(HalfEdgeTest, SpecksOnARoughSurfaceVanishAtTheirPrice) {
  TestMesh mesh = tests::torus(3000, 0.03F);
  const std::uint32_t surface = tests::count_of(mesh.positions);
  for (std::uint32_t i = 0; i < 200; ++i)
    tests::append(mesh, tests::soup(1), mesh.positions[7 * i] * 1.02F, 0.002F);
  const Contraction found = contracted(tests::tile_of(mesh), surface / 2);
  EXPECT_GT(found.fallbacks.torn, 0U);
  EXPECT_EQ(found.fallbacks.without_care(), 0U);
}

TEST_P(HalfEdgeTest, NothingToDoChangesNothing) {
  for (const auto& [name, mesh] : tests::nasty_meshes()) {
    SCOPED_TRACE(name);
    const BuildTile tile = tests::tile_of(mesh);
    const Contraction found = contracted(tile, tile.mesh.own_count);
    std::vector<std::uint32_t> identity(tile.mesh.own_count);
    std::iota(identity.begin(), identity.end(), 0U);
    EXPECT_EQ(found.parent_of, identity);
    EXPECT_EQ(found.representatives.positions, mesh.positions);
  }
}

TEST_P(HalfEdgeTest, PowersOfTwoAndExactShiftsChangeNothing) {
  TestMesh mesh = tests::sphere(1500, 0.03F);
  for (Vec3f& p : mesh.positions) {
    p = {std::round(p.x * 1024) / 1024, std::round(p.y * 1024) / 1024,
         std::round(p.z * 1024) / 1024};
  }
  const Contraction expected = contracted(tests::tile_of(mesh), 120);
  const auto moved = [&](float factor, Vec3f shift) {
    TestMesh other = mesh;
    for (Vec3f& p : other.positions)
      p = p * factor + shift;
    return contracted(tests::tile_of(other), 120).parent_of;
  };
  for (const int power : {-100, -1, 5, 100})
    EXPECT_EQ(moved(std::exp2(static_cast<float>(power)), {}), expected.parent_of) << power;
  EXPECT_EQ(moved(1, {4096, -2048, 1000}), expected.parent_of);
  EXPECT_EQ(moved(1, {0, 0, 8000}), expected.parent_of);
}

TEST_P(HalfEdgeTest, AnyUnitGivesAsRoundASphere) {
  for (const float unit : {1e30F, 1e-30F, 3e-39F, 3.4e38F}) {
    TestMesh mesh = tests::sphere(4000);
    for (Vec3f& p : mesh.positions)
      p = p * unit;
    const BuildTile tile = tests::tile_of(mesh);
    const Contraction found = contracted(tile, 100);
    expect_subset(tile, found);
    EXPECT_EQ(found.fallbacks.torn + found.fallbacks.without_care(), 0U);
    const TestMesh image = tests::image_of(tile, found);
    for (const MeshTriangle& t : image.triangles) {
      Vec3d centre{};
      for (const std::uint32_t v : t)
        centre = centre + to_double(image.positions[v]) * (1 / (3 * double{unit}));
      ASSERT_GT(length(centre), 0.8) << unit;
    }
  }
}

// ---- what differs between the costs --------------------------------------------------------

TEST(HalfEdgeQuadricTest, AHubOfTwentyThousandSpokesIsContracted) {
  const BuildTile tile = tests::tile_of(tests::wheel(20'000, 0.4F));
  for (const std::uint32_t target : {10'000U, 100U}) {
    const Contraction found = half_edge(tile, target, HalfEdgeCost::quadric);
    EXPECT_EQ(found.representatives.size(), target);
    EXPECT_EQ(found.fallbacks.torn + found.fallbacks.without_care(), 0U);
    EXPECT_EQ(found.representatives.positions[0], (Vec3f{0, 0, 0.4F}));  // the tip
  }
}

TEST(HalfEdgeMelaxTest, AHubIsContracted) {
  // A spoke's cost looks at all triangles around the hub.
  const BuildTile tile = tests::tile_of(tests::wheel(1000, 0.4F));
  const Contraction found = half_edge(tile, 100, HalfEdgeCost::melax);
  EXPECT_EQ(found.representatives.size(), 100U);
  EXPECT_EQ(found.representatives.positions[0], (Vec3f{0, 0, 0.4F}));
}

}  // namespace
}  // namespace meshhier::cluster_simplify
