#include "cluster_simplify/edge_collapse.h"

#include "base/srgb.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::Each;
using tests::MeshTriangle;
using tests::TestMesh;

constexpr AttributeLayout kColours{false, ColourType::f32, false, false};

struct Result {
  BuildTile tile;
  Contraction contraction;
  TestMesh image;
};

Result contracted(BuildTile tile, std::uint32_t target, const AttributeLayout& layout = {}) {
  Contraction contraction = edge_collapse(tile, target, layout);
  TestMesh image = tests::image_of(tile, contraction);
  return {std::move(tile), std::move(contraction), std::move(image)};
}

Result contracted(const TestMesh& mesh, std::uint32_t target) {
  return contracted(tests::tile_of(mesh), target);
}

void expect_no_fallbacks(const FallbackCounts& counts) {
  EXPECT_EQ(counts.torn, 0U);
  EXPECT_EQ(counts.without_care(), 0U);
}

/// How high an inscribed plane lies below a unit sphere that `count` vertices cover evenly: 2 count
/// triangles of area 4 pi / (2 count), equilateral, edge squared L^2 = 4 / sqrt(3) times that,
/// circumradius L / sqrt(3), so depth L^2 / 6.
double depth_under_sphere(std::uint32_t count) {
  const double squared_edge = 4 / std::numbers::sqrt3 * 2 * std::numbers::pi / count;
  return squared_edge / 6;
}

double length_of(const TestMesh& mesh, const std::vector<tests::Edge>& edges) {
  double sum = 0;
  for (const tests::Edge& e : edges)
    sum += tests::distance(mesh.positions[e[0]], mesh.positions[e[1]]);
  return sum;
}

double area_of(const TestMesh& mesh) {
  double sum = 0;
  for (const MeshTriangle& t : mesh.triangles)
    sum += length(tests::doubled_normal(mesh, t)) / 2;
  return sum;
}

// ---- shape ---------------------------------------------------------------------------------

TEST(EdgeCollapseTest, AFlatGridStaysFlatWithItsBordersAndCorners) {
  constexpr float kSide = 32;
  constexpr double kTolerance = 1e-5 * kSide;
  for (const std::uint32_t target : {400U, 100U, 30U}) {
    const auto [tile, found, image] = contracted(tests::open_grid(32, 32), target);
    expect_no_fallbacks(found.fallbacks);
    for (const Vec3f p : found.representatives.positions)
      ASSERT_NEAR(p.z, 0, kTolerance);
    for (const Vec3f corner :
         {Vec3f{0, 0, 0}, Vec3f{kSide, 0, 0}, Vec3f{0, kSide, 0}, Vec3f{kSide, kSide, 0}})
      EXPECT_LT(tests::distance_to_nearest(corner, found.representatives.positions), kTolerance);
    for (const tests::Edge& e : tests::boundary_edges(image.triangles)) {
      for (const std::uint32_t v : e) {
        const Vec3f p = image.positions[v];
        EXPECT_LT(
            std::min({std::abs(p.x), std::abs(p.y), std::abs(p.x - kSide), std::abs(p.y - kSide)}),
            kTolerance);
      }
    }
    // Upright on all of them and together the whole square: no overlap, no hole.
    for (const MeshTriangle& t : image.triangles)
      EXPECT_GE(tests::doubled_normal(image, t).z, 0);
    EXPECT_NEAR(area_of(image), kSide * kSide, 4 * kSide * kTolerance);
  }
}

TEST(EdgeCollapseTest, ACubeIsDownToItsCorners) {
  for (const std::uint32_t target : {50U, 12U, 8U}) {
    const auto [tile, found, image] = contracted(tests::cube(16), target);
    expect_no_fallbacks(found.fallbacks);
    for (const Vec3f corner : tests::cube_corners())
      EXPECT_LT(tests::distance_to_nearest(corner, found.representatives.positions), 1e-4);
    EXPECT_TRUE(tests::is_closed(image.triangles));
    EXPECT_EQ(tests::euler_characteristic(image.triangles), 2);
    EXPECT_NEAR(area_of(image), 24, 1e-3);
  }
}

TEST(EdgeCollapseTest, ASphereIsAsRoundAsItsVertexCountAllows) {
  for (const std::uint32_t target : {2000U, 500U, 100U}) {
    const auto [tile, found, image] = contracted(tests::sphere(16'384), target);
    expect_no_fallbacks(found.fallbacks);
    // Least squares puts vertices outside by part of the depth; twice is for uneven triangles.
    for (const Vec3f p : found.representatives.positions)
      ASSERT_NEAR(length(to_double(p)), 1, 2 * depth_under_sphere(target));
    for (const MeshTriangle& t : image.triangles) {
      const Vec3d centre = (to_double(image.positions[t[0]]) + to_double(image.positions[t[1]]) +
                            to_double(image.positions[t[2]])) *
                           (1.0 / 3);
      ASSERT_NEAR(length(centre), 1, 2 * depth_under_sphere(target));
      const Vec3d normal = tests::doubled_normal(image, t);
      ASSERT_GT(dot(normal, centre), 0.8 * length(normal)) << "turned over, or a fold";
    }
  }
}

TEST(EdgeCollapseTest, NoTriangleOfABumpySphereIsTurnedOver) {
  const TestMesh mesh = tests::sphere(8192, 0.004F);
  for (const std::uint32_t target : {1500U, 400U, 100U}) {
    const auto [tile, found, image] = contracted(mesh, target);
    expect_no_fallbacks(found.fallbacks);
    for (const MeshTriangle& t : image.triangles)
      EXPECT_GT(dot(tests::doubled_normal(image, t), to_double(image.positions[t[0]])), 0);
  }
}

TEST(EdgeCollapseTest, ANoisyTorusStaysATorus) {
  for (const std::uint32_t target : {1000U, 300U, 50U}) {
    const auto [tile, found, image] = contracted(tests::torus(9600, 0.003F), target);
    expect_no_fallbacks(found.fallbacks);
    EXPECT_TRUE(tests::is_closed(image.triangles));
    EXPECT_EQ(tests::euler_characteristic(image.triangles), 0);
    EXPECT_EQ(image.triangles.size(), 2 * target);
    EXPECT_EQ(tests::component_count(image), 1U);
  }
}

TEST(EdgeCollapseTest, OpenBordersSurvive) {
  TestMesh holes = tests::open_grid(40, 40);
  std::erase_if(holes.triangles, [&](const MeshTriangle& t) {
    const Vec3f p = holes.positions[t[0]];
    return std::fmod(p.x, 10.0F) > 3 && std::fmod(p.x, 10.0F) < 8 && p.y > 10 && p.y < 15;
  });
  for (const TestMesh& mesh : {tests::moebius(4096), holes}) {
    const std::vector<tests::Edge> before = tests::boundary_edges(mesh.triangles);
    const auto [tile, found, image] = contracted(mesh, 100);
    const std::vector<tests::Edge> after = tests::boundary_edges(image.triangles);
    expect_no_fallbacks(found.fallbacks);
    EXPECT_EQ(tests::border_line_count(image.triangles), tests::border_line_count(mesh.triangles));
    EXPECT_NEAR(length_of(image, after), length_of(mesh, before), 0.01 * length_of(mesh, before));
    EXPECT_NEAR(area_of(image), area_of(mesh), 0.01 * area_of(mesh));
  }
}

TEST(EdgeCollapseTest, SheetsThatMeetInALineStayAndMeet) {
  const auto [tile, found, image] = contracted(tests::non_manifold(2000), 60);
  std::vector<tests::Edge> edges = tests::undirected_edges(image.triangles);
  EXPECT_TRUE(std::ranges::any_of(edges, [&](const tests::Edge& e) {
    return std::ranges::count(edges, e) == 3 && image.positions[e[0]].y > -1;
  }));
  EXPECT_NEAR(area_of(image), area_of(tests::non_manifold(2000)), 0.02 * area_of(image));
}

TEST(EdgeCollapseTest, GhostsStayAndHoldWhatIsNextToThem) {
  const BuildTile part = tests::part_of(tests::sphere(8192), 0.3F);
  const auto [tile, found, image] = contracted(part, 200);
  expect_no_fallbacks(found.fallbacks);
  for (const Vec3f p : found.representatives.positions)
    EXPECT_NEAR(length(to_double(p)), 1, 2 * depth_under_sphere(200));
  // Border triangles still reach every ghost they have to: the image has no border but the ghosts'.
  for (const tests::Edge& e : tests::boundary_edges(image.triangles))
    EXPECT_TRUE(e[0] >= 200 && e[1] >= 200) << e[0] << "-" << e[1];
}

TEST(EdgeCollapseTest, PlanesThatMeetFarAwayDoNotMakeASpike) {
  // A needle of three sides without its tip, on ghosts; its planes meet 0.44 above, its edges there
  // are 0.017 long.
  TestMesh needle;
  for (const Vec3d ring : {Vec3d{0.01, 0, 0}, Vec3d{0.1, 0, -4}}) {
    for (int i = 0; i < 3; ++i) {
      const double angle = 2 * std::numbers::pi * i / 3;
      needle.positions.push_back(
          tests::vec3f(ring.x * std::cos(angle), ring.x * std::sin(angle), ring.z));
    }
  }
  needle.triangles = {{0, 1, 2}, {3, 4, 1}, {3, 1, 0}, {4, 5, 2}, {4, 2, 1}, {5, 3, 0}, {5, 0, 2}};
  const auto [tile, found, image] = contracted(tests::tile_of(needle, 3), 2);
  for (const Vec3f p : found.representatives.positions)
    EXPECT_LT(p.z, 0.04);
}

TEST(EdgeCollapseTest, AVertexThatNeverMovedIsTheSameBitForBit) {
  const TestMesh mesh = tests::sphere(2000, 0.03F);
  const std::uint32_t target = tests::count_of(mesh.positions) - 40;
  const auto [tile, found, image] = contracted(mesh, target);
  std::vector<std::uint32_t> group_sizes(target);
  for (const std::uint32_t parent : found.parent_of)
    ++group_sizes[parent];
  for (std::uint32_t v = 0; v < found.parent_of.size(); ++v) {
    const std::uint32_t parent = found.parent_of[v];
    if (group_sizes[parent] == 1) {
      ASSERT_EQ(found.representatives.positions[parent], mesh.positions[v]);
    }
  }
  EXPECT_GT(std::ranges::count(group_sizes, 1U), 0);
}

// ---- attributes ----------------------------------------------------------------------------

TEST(EdgeCollapseTest, LinearColoursStayLinearOnFlatGround) {
  constexpr float kSide = 32;
  BuildTile grid = tests::tile_of(tests::open_grid(32, 32));
  VertexArray& vertices = grid.mesh.vertices;
  vertices.channels = 3;
  for (const Vec3f p : vertices.positions)
    vertices.attributes.insert(vertices.attributes.end(), {p.x, p.y, kSide - p.x - p.y});
  for (const std::uint32_t target : {500U, 100U, 30U}) {
    const auto [tile, found, image] =
        contracted(grid, target, {.colour = ColourType::f32, .space = ColourSpace::linear});
    // At a border a point lies beside its edge, where interpolation along the edge says the same as
    // at its foot: a part of the mean distance of the vertices.
    const double spacing = kSide / std::sqrt(target);
    double sum = 0;
    for (std::uint32_t i = 0; i < target; ++i) {
      const Vec3f p = found.representatives.positions[i];
      const auto colour = found.representatives.attributes_of(i);
      ASSERT_NEAR(colour[0], p.x, 0.3 * spacing);
      ASSERT_NEAR(colour[1], p.y, 0.3 * spacing);
      ASSERT_NEAR(colour[0] + colour[1] + colour[2], kSide, 1e-4 * kSide);
      sum += std::abs(double{colour[0]} - double{p.x});
    }
    EXPECT_LT(sum / target, 0.1 * spacing);
  }
}

TEST(EdgeCollapseTest, ColoursOfAScreenAreMixedAsLight) {
  BuildTile grid = tests::tile_of(tests::open_grid(32, 32));
  VertexArray& vertices = grid.mesh.vertices;
  vertices.channels = 3;
  std::size_t i = 0;
  for (const Vec3f p : vertices.positions) {
    const float stripe = static_cast<int>(p.x) % 2 == 0 ? 0.0F : 255.0F;
    vertices.attributes.insert(vertices.attributes.end(), {stripe, 124, i++ % 2 == 0 ? 0.0F : 255});
  }
  const auto [tile, found, image] = contracted(grid, 40, {.colour = ColourType::u8});
  double light = 0;
  for (std::uint32_t v = 0; v < 40; ++v) {
    const auto colour = found.representatives.attributes_of(v);
    light += light_of(colour[0] / 255.0) / 40;
    ASSERT_EQ(colour[1], 124);  // equal ones stay so, bit for bit
  }
  EXPECT_NEAR(light, 0.5, 0.15);  // half of the numbers' range would be 0.21
}

TEST(EdgeCollapseTest, ColoursStayBetweenThoseOfTheirVertices) {
  BuildTile ball = tests::tile_of(tests::sphere(3000, 0.02F));
  tests::add_attributes(ball);
  const Contraction found = edge_collapse(ball, 100, tests::kAllAttributes);
  const auto channels = static_cast<std::size_t>(ball.mesh.vertices.channels);
  std::vector<float> low(100 * channels, std::numeric_limits<float>::infinity());
  std::vector<float> high(100 * channels, -std::numeric_limits<float>::infinity());
  for (std::uint32_t v = 0; v < found.parent_of.size(); ++v) {
    for (std::size_t k = 0; k < channels; ++k) {
      const std::size_t place = found.parent_of[v] * channels + k;
      low[place] = std::min(low[place], ball.mesh.vertices.attributes_of(v)[k]);
      high[place] = std::max(high[place], ball.mesh.vertices.attributes_of(v)[k]);
    }
  }
  for (std::size_t i = 0; i < low.size(); ++i) {
    if (i % channels < 3)
      continue;  // normals are made longer
    const float slack = 1e-5F * std::max(std::abs(low[i]), std::abs(high[i]));
    ASSERT_GE(found.representatives.attributes[i], low[i] - slack);
    ASSERT_LE(found.representatives.attributes[i], high[i] + slack);
  }
}

TEST(EdgeCollapseTest, NormalsPointWhereTheirVerticesDo) {
  BuildTile ball = tests::tile_of(tests::sphere(3000));
  ball.mesh.vertices.channels = 3;
  for (const Vec3f p : ball.mesh.vertices.positions)
    ball.mesh.vertices.attributes.insert(ball.mesh.vertices.attributes.end(), {p.x, p.y, p.z});
  const Contraction found = edge_collapse(ball, 150, AttributeRules({.normals = true}));
  for (std::uint32_t i = 0; i < 150; ++i) {
    const auto n = found.representatives.attributes_of(i);
    const Vec3d normal{n[0], n[1], n[2]};
    const Vec3d place = to_double(found.representatives.positions[i]);
    EXPECT_NEAR(length(normal), 1, 1e-6);
    EXPECT_GT(dot(normal, place), 0.99 * length(place));
  }
}

// ---- what is given up when nothing else is left --------------------------------------------

TEST(EdgeCollapseTest, SpecksOnARoughSurfaceVanishAtTheirPrice) {
  // Rough enough that its own vertices cost more than specks next to them.
  TestMesh mesh = tests::torus(3000, 0.03F);
  const std::uint32_t surface = tests::count_of(mesh.positions);
  for (std::uint32_t i = 0; i < 200; ++i)
    tests::append(mesh, tests::soup(1), mesh.positions[7 * i] * 1.02F, 0.002F);
  const std::size_t specks = 200;
  const auto [tile, found, image] = contracted(mesh, surface / 2);
  EXPECT_GT(found.fallbacks.torn, 0U);
  EXPECT_EQ(found.fallbacks.without_care(), 0U);
  EXPECT_LT(tests::component_count(image), 1 + specks / 2);
}

TEST(EdgeCollapseTest, SpecksNextToTheSurfaceVanishBeforeThoseFarFromIt) {
  TestMesh mesh = tests::torus(3000, 0.03F);
  const std::uint32_t surface = tests::count_of(mesh.positions);
  for (std::uint32_t i = 0; i < 100; ++i) {
    tests::append(mesh, tests::soup(1), mesh.positions[7 * i] * 1.02F, 0.002F);
    tests::append(mesh, tests::soup(1), mesh.positions[7 * i + 3] * 3.0F, 0.002F);
  }
  const auto [tile, found, image] = contracted(mesh, surface + 300);
  std::size_t near = 0;
  std::size_t far = 0;
  for (const MeshTriangle& t : image.triangles) {
    if (length(tests::doubled_normal(image, t)) < 1e-5)
      ++(length(to_double(image.positions[t[0]])) < 1.15 ? near : far);
  }
  EXPECT_LT(near, 20U);
  EXPECT_GT(far, 90U);
  EXPECT_EQ(found.fallbacks.torn, 200 - near - far);
  EXPECT_EQ(found.fallbacks.without_care(), 0U);
}

TEST(EdgeCollapseTest, ASpeckFarAwayIsKept) {
  TestMesh mesh = tests::torus(3000, 0.03F);
  const std::uint32_t surface = tests::count_of(mesh.positions);
  tests::append(mesh, tests::cube(1), {30, 0, 0}, 0.2F);
  const auto [tile, found, image] = contracted(mesh, surface / 4);
  EXPECT_EQ(tests::component_count(image), 2U);
}

TEST(EdgeCollapseTest, TrianglesTurnOverWhereNoPlaceKeepsThem) {
  for (const MeshTriangle& t : tests::z_ring().triangles)
    ASSERT_GT(tests::doubled_normal(tests::z_ring(), t).z, 0);
  const Contraction found = edge_collapse(tests::tile_of(tests::z_ring(), 2), 1, {});
  EXPECT_EQ(found.fallbacks.torn, 0U);
  EXPECT_EQ(found.fallbacks.turned, 1U);
  EXPECT_EQ(found.fallbacks.forced, 0U);
  EXPECT_EQ(found.fallbacks.joined, 0U);
}

TEST(EdgeCollapseTest, SoupVanishesTriangleByTriangle) {
  constexpr std::uint32_t kTriangles = 50;
  TestMesh soup = tests::soup(kTriangles);
  for (std::size_t i = 0; i < soup.triangles.size(); i += 2)
    std::swap(soup.triangles[i][1], soup.triangles[i][2]);
  for (const std::uint32_t target : {149U, 120U, 31U, 1U}) {
    const auto [tile, found, image] = contracted(soup, target);
    EXPECT_EQ(found.fallbacks.torn, (3 * kTriangles - target + 2) / 3);  // three vertices each
    EXPECT_EQ(found.fallbacks.turned, 0U);
    EXPECT_EQ(found.fallbacks.forced, 0U);
    EXPECT_EQ(found.fallbacks.joined, 0U);
    EXPECT_EQ(image.triangles.size(), target / 3);
  }
}

TEST(EdgeCollapseTest, VerticesTiedOnlyToGhostsAreJoined) {
  // Every own vertex in a triangle of its own with two ghosts.
  TestMesh mesh = tests::points(30);
  mesh.positions.insert(mesh.positions.end(), {{3, 0, 0}, {3, 1, 0}});
  for (std::uint32_t v = 0; v < 30; ++v)
    mesh.triangles.push_back({v, 30, 31});
  for (const std::uint32_t target : {29U, 7U, 1U}) {
    const Contraction found = edge_collapse(tests::tile_of(mesh, 30), target, {});
    EXPECT_EQ(found.fallbacks.joined, 30 - target);
    EXPECT_EQ(found.fallbacks.torn + found.fallbacks.turned + found.fallbacks.forced, 0U);
    EXPECT_EQ(found.representatives.size(), target);
  }
}

TEST(EdgeCollapseTest, ACloudOfPointsNeedsNoForce) {
  const Contraction found = edge_collapse(tests::tile_of(tests::points(300)), 40, {});
  expect_no_fallbacks(found.fallbacks);
  for (const Vec3f p : found.representatives.positions)
    EXPECT_EQ(tests::distance_to_nearest(p, tests::points(300).positions), 0);
}

TEST(EdgeCollapseTest, LoneVerticesMakeRoomForTheSurface) {
  TestMesh mesh = tests::torus(1000);
  const std::uint32_t surface = tests::count_of(mesh.positions);
  tests::append(mesh, tests::points(400), {}, 0.25F);  // within the torus's box
  const std::uint32_t target = surface / 2;
  const auto [tile, found, image] = contracted(mesh, target);
  expect_no_fallbacks(found.fallbacks);
  EXPECT_EQ(image.triangles.size(), 2 * target);  // closed, of genus 1: all of them are used
  const Contraction alone = edge_collapse(tests::tile_of(tests::torus(1000)), target, {});
  EXPECT_EQ(found.representatives.positions, alone.representatives.positions);
}

TEST(EdgeCollapseTest, AHubOfTwentyThousandSpokesIsContracted) {
  constexpr std::uint32_t kSpokes = 20'000;
  for (const std::uint32_t target : {kSpokes / 2, 100U}) {
    const auto [tile, found, image] = contracted(tests::wheel(kSpokes, 0.4F), target);
    EXPECT_EQ(found.representatives.size(), target);
    expect_no_fallbacks(found.fallbacks);
    EXPECT_NEAR(area_of(image), std::numbers::pi * std::sqrt(1.16), 0.01);
  }
}

// ---- counts, places, units -----------------------------------------------------------------

TEST(EdgeCollapseTest, NothingToDoChangesNothing) {
  for (const auto& [name, mesh] : tests::nasty_meshes()) {
    SCOPED_TRACE(name);
    const BuildTile tile = tests::tile_of(mesh);
    const Contraction found = edge_collapse(tile, tile.mesh.own_count, {});
    std::vector<std::uint32_t> identity(tile.mesh.own_count);
    std::iota(identity.begin(), identity.end(), 0U);
    EXPECT_EQ(found.parent_of, identity);
    EXPECT_EQ(found.representatives.positions, mesh.positions);
    expect_no_fallbacks(found.fallbacks);
  }
}

TEST(EdgeCollapseTest, OneIsLeftOfAnything) {
  for (const auto& [name, mesh] : tests::nasty_meshes()) {
    SCOPED_TRACE(name);
    for (const BuildTile& tile : {tests::tile_of(mesh), tests::part_of(mesh, 0.3F)}) {
      if (tile.mesh.own_count == 0)
        continue;
      const Contraction found = edge_collapse(tile, 1, {});
      EXPECT_EQ(found.representatives.size(), 1U);
      EXPECT_THAT(found.parent_of, Each(0U));
    }
  }
}

TEST(EdgeCollapseTest, PowersOfTwoScaleTheResultAndNothingElse) {
  for (const TestMesh& mesh : {tests::sphere(1500, 0.03F), tests::open_grid(25, 20, 0.3F),
                               tests::non_manifold(600, 0.01F), tests::soup(100)}) {
    const Contraction expected = edge_collapse(tests::tile_of(mesh), 120, {});
    for (const int power : {-100, -3, 1, 100}) {
      TestMesh scaled = mesh;
      const float factor = std::exp2(static_cast<float>(power));
      for (Vec3f& p : scaled.positions)
        p = p * factor;
      const Contraction found = edge_collapse(tests::tile_of(scaled), 120, {});
      ASSERT_EQ(found.parent_of, expected.parent_of) << "2^" << power;
      for (std::size_t i = 0; i < 120; ++i)
        ASSERT_EQ(found.representatives.positions[i],
                  expected.representatives.positions[i] * factor);
    }
  }
}

TEST(EdgeCollapseTest, AShiftThatFloatsHoldExactlyChangesNothing) {
  // Places are multiples of 2^-10 below 8, and the shifts below 2^13: 23 bits.
  TestMesh mesh = tests::sphere(1500, 0.03F);
  for (Vec3f& p : mesh.positions) {
    p = {std::round(p.x * 1024) / 1024, std::round(p.y * 1024) / 1024,
         std::round(p.z * 1024) / 1024};
  }
  const Contraction expected = edge_collapse(tests::tile_of(mesh), 120, {});
  for (const Vec3f shift : {Vec3f{4096, -2048, 1000}, Vec3f{0, 0, 8000}}) {
    TestMesh shifted = mesh;
    for (Vec3f& p : shifted.positions)
      p = p + shift;
    const Contraction found = edge_collapse(tests::tile_of(shifted), 120, {});
    EXPECT_EQ(found.parent_of, expected.parent_of);
    for (std::size_t i = 0; i < 120; ++i) {
      EXPECT_LT(tests::distance(found.representatives.positions[i],
                                expected.representatives.positions[i] + shift),
                2e-3);
    }
  }
}

TEST(EdgeCollapseTest, AnyUnitGivesAsRoundASphere) {
  for (const float unit : {1e30F, 1e-30F, 3e-39F, 3.3e38F}) {
    TestMesh mesh = tests::sphere(4000);
    for (Vec3f& p : mesh.positions)
      p = p * unit;
    const auto [tile, found, image] = contracted(mesh, 100);
    expect_no_fallbacks(found.fallbacks);
    for (const Vec3f p : found.representatives.positions)
      ASSERT_NEAR(length(to_double(p)) / double{unit}, 1, 2 * depth_under_sphere(100)) << unit;
  }
}

TEST(EdgeCollapseTest, TheLargestFloatsStayFinite) {
  TestMesh mesh = tests::sphere(4000);
  for (Vec3f& p : mesh.positions)
    p = p * std::numeric_limits<float>::max();
  for (const Vec3f p : edge_collapse(tests::tile_of(mesh), 30, {}).representatives.positions)
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

}  // namespace
}  // namespace meshhier::cluster_simplify
