// Deviations of whole contractions: of `cluster`, by motion, and of all other methods.
#include "cluster_simplify/motion.h"

#include "cluster_simplify/contraction.h"
#include "tests/cluster_simplify/collapsing.h"
#include "tests/cluster_simplify/sampling.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::Corners;
using tests::distance_to_surface;
using tests::samples_of;
using tests::surface_of;

constexpr int kMotionSteps = 4;
constexpr double kMotionSlack = 1e-6;  // rounding of single precision at the size of the meshes

/// Returns how far the triangles around each representative may have deviated, as neighbours will
/// see it.
double deviation_of(const Contraction& contraction, const tests::MeshTriangle& t) {
  double deviation = std::numeric_limits<double>::infinity();
  for (const std::uint32_t v : t) {
    if (v < contraction.deviation.around.size())
      deviation = std::min(deviation, double{contraction.deviation.around[v]});
  }
  return deviation;
}

double size_of(const BuildTile& tile) {
  double size = 0;
  for (const Vec3f p : tile.mesh.vertices.positions)
    size = std::max(size, length(to_double(p) - to_double(tile.mesh.vertices.positions[0])));
  return size;
}

/// Every point that is drawn is within its triangle's deviation of the joined surface.
void expect_drawn_near(const BuildTile& tile, const Contraction& found,
                       const tests::TestMesh& image, double slack) {
  const std::vector<Corners> before = surface_of(tile.mesh);
  const auto own = static_cast<std::uint32_t>(found.representatives.size());
  for (const tests::MeshTriangle& t : image.triangles) {
    const bool is_interior = std::ranges::all_of(t, [&](std::uint32_t v) { return v < own; });
    const double deviation =
        is_interior ? std::min(deviation_of(found, t), double{found.deviation.interior})
                    : deviation_of(found, t);
    const Corners corners = surface_of(tests::TestMesh{image.positions, {t}})[0];
    for (const Vec3d p : samples_of(corners, kMotionSteps))
      ASSERT_LE(distance_to_surface(p, before), deviation + slack);
  }
}

/// Every point of the joined surface is within the deviation of a drawn triangle, or within `lost`
/// of one.
void expect_joined_near(const BuildTile& tile, const Contraction& found,
                        const tests::TestMesh& image, double slack) {
  if (image.triangles.empty()) {
    EXPECT_TRUE(tile.mesh.interior.empty() || std::isinf(found.deviation.lost));
    return;
  }
  const std::vector<Corners> after = surface_of(image);
  std::vector<double> deviations;
  for (const tests::MeshTriangle& t : image.triangles)
    deviations.push_back(std::max(deviation_of(found, t), double{found.deviation.lost}));
  for (const Corners& corners : surface_of(tile.mesh)) {
    for (const Vec3d p : samples_of(corners, kMotionSteps)) {
      double missing = std::numeric_limits<double>::infinity();
      for (std::size_t t = 0; t < after.size(); ++t)
        missing = std::min(missing, tests::distance_to_triangle(p, after[t]) - deviations[t]);
      ASSERT_LE(missing, slack);
    }
  }
}

void expect_deviation_holds(const BuildTile& tile, const Contraction& found) {
  ASSERT_EQ(found.deviation.around.size(), found.representatives.size());
  EXPECT_GE(found.deviation.mean_square, 0);
  const tests::TestMesh image = tests::image_of(tile, found);
  const double slack = kMotionSlack * size_of(tile);
  expect_drawn_near(tile, found, image, slack);
  expect_joined_near(tile, found, image, slack);
}

const std::vector<std::pair<std::string, ContractionOptions>>& all_methods() {
  static const std::vector<std::pair<std::string, ContractionOptions>> all = {
      {"cluster_mean", {Method::cluster, Representative::mean, {}}},
      {"cluster_quadric", {Method::cluster, Representative::quadric, {}}},
      {"cluster_vertex", {Method::cluster, Representative::vertex, {}}},
      {"edge_collapse", {Method::edge_collapse, {}, {}}},
      {"half_edge_quadric", {Method::half_edge, {}, HalfEdgeCost::quadric}},
      {"half_edge_melax", {Method::half_edge, {}, HalfEdgeCost::melax}}};
  return all;
}

/// As nasty_meshes(), but few enough triangles to compare all with all.
std::vector<tests::NamedMesh> small_meshes() {
  tests::TestMesh specks = tests::sphere(150, 0.02F);
  tests::append(specks, tests::soup(20), {0.2F, 0, 0}, 1.5F);
  tests::TestMesh line = tests::open_grid(8, 3);
  for (Vec3f& p : line.positions)
    p.y = p.z = 0;
  return {{"sphere", tests::sphere(200, 0.03F)},
          {"genus", tests::genus_n(2, 250)},
          {"shells", tests::nested_shells(250)},
          {"grid", tests::open_grid(9, 9, 0.2F)},
          {"strip", tests::open_grid(40, 1)},
          {"moebius", tests::moebius(150)},
          {"non-manifold", tests::non_manifold(200, 0.01F)},
          {"soup", tests::soup(50)},
          {"duplicates", tests::duplicates(250, 0.02F)},
          {"mirrored", tests::mirrored(tests::sphere(100))},
          {"tangle", tests::tangle(40, 150, 1)},
          {"specks", specks},
          {"without area", line},
          {"hub", tests::wheel(60, 0.3F)},
          {"one triangle", tests::soup(1)}};
}

class ContractionDeviationTest : public testing::TestWithParam<std::size_t> {};

TEST_P(ContractionDeviationTest, SLOW_HoldsBothWaysOnAnything) {
  const auto& [method, options] = all_methods()[GetParam()];
  for (const auto& [name, mesh] : small_meshes()) {
    std::vector<BuildTile> tiles{tests::tile_of(mesh), tests::part_of(mesh, 0.3F)};
    for (const BuildTile& tile : tiles) {
      const std::uint32_t own = tile.mesh.own_count;
      for (const std::uint32_t target : {own * 3 / 4, own / 2, own / 4, own / 16, 4U, 3U}) {
        if (target < 1 || target > own)
          continue;
        SCOPED_TRACE(method + " of " + name + (tile.mesh.ghosts.empty() ? "" : ", a part") +
                     " to " + std::to_string(target));
        expect_deviation_holds(tile, contract(tile, target, {}, options));
        if (HasFailure())
          return;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, ContractionDeviationTest,
                         testing::Range(std::size_t{0}, std::size_t{6}),
                         [](const auto& tested) { return all_methods()[tested.param].first; });

// ---- means ---------------------------------------------------------------------------------

/// The mean over area of the joined surface's distance to what is drawn.
double mean_distance(const BuildTile& tile, const Contraction& found) {
  const std::vector<Corners> after = surface_of(tests::image_of(tile, found));
  double sum = 0;
  double whole = 0;
  for (const Corners& corners : surface_of(tile.mesh)) {
    const std::vector<Vec3d> samples = samples_of(corners, kMotionSteps);
    const double area = length(cross(corners[1] - corners[0], corners[2] - corners[0]));
    for (const Vec3d p : samples)
      sum += area / static_cast<double>(samples.size()) * distance_to_surface(p, after);
    whole += area;
  }
  return sum / whole;
}

/// A flat grid with one vertex far above it.
tests::TestMesh spiked_grid(float height) {
  tests::TestMesh mesh = tests::open_grid(12, 12);
  mesh.positions[13 * 6 + 6].z = height;
  return mesh;
}

TEST(MeanSquareTest, OneSpikeHoldsMostOfTheArea) {
  constexpr double kFoot = 1e-4;  // where a spike stays, its foot changes
  for (const auto& [method, options] : all_methods()) {
    for (const float height : {30.0F, 1000.0F}) {
      SCOPED_TRACE(method + ", height " + std::to_string(height));
      const BuildTile tile = tests::tile_of(spiked_grid(height));
      for (const std::uint32_t target : {42U, 10U}) {
        const Contraction found = contract(tile, target, {}, options);
        const double told = std::sqrt(found.deviation.mean_square);
        EXPECT_LE(mean_distance(tile, found), 2 * told + kFoot * double{height});
      }
    }
  }
}

// ---- pieces that are drawn no more ---------------------------------------------------------

/// A square of two triangles, and a triangle that touches it in a corner alone.
tests::TestMesh flag() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {3, 0, 0}, {3, 1, 0}},
          {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}}};
}

TEST(LostPiecesTest, ATriangleThatHungOnACornerIsLost) {
  const BuildTile tile = tests::tile_of(flag());
  tests::Collapsing collapsing(tile);
  collapsing.collapse(5, 4);
  const Contraction found = collapsing.choose(4);
  EXPECT_GE(found.deviation.lost, 2);
  expect_deviation_holds(tile, found);
}

TEST(LostPiecesTest, AFanThatHungOnACornerIsLost) {
  tests::TestMesh mesh = flag();
  mesh.positions.push_back({3, 2, 0});
  mesh.triangles.push_back({1, 5, 6});
  const BuildTile tile = tests::tile_of(mesh);
  tests::Collapsing collapsing(tile);
  collapsing.collapse(6, 5);
  collapsing.collapse(5, 4);
  const Contraction found = collapsing.choose(4);
  EXPECT_GE(found.deviation.lost, 2);
  expect_deviation_holds(tile, found);
}

TEST(LostPiecesTest, ALonePieceIsLost) {
  tests::TestMesh mesh = tests::sphere(100);
  tests::append(mesh, tests::soup(1), {5, 0, 0}, 0.1F);
  const BuildTile tile = tests::tile_of(mesh);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() - 3);
  tests::Collapsing collapsing(tile);
  collapsing.collapse(first + 1, first);
  const Contraction found = collapsing.choose(first);
  EXPECT_GE(found.deviation.lost, 3.5);
  EXPECT_LE(found.deviation.lost, 6.5);
  const auto count = static_cast<double>(mesh.positions.size());
  EXPECT_GE(found.deviation.mean_square * count, 3 * 3.5 * 3.5);  // for its three vertices
  EXPECT_LE(found.deviation.mean_square * count, 3 * 6.5 * 6.5);
  expect_deviation_holds(tile, found);
}

TEST(LostPiecesTest, VerticesThatNeverShowedAnythingLoseNothing) {
  tests::TestMesh mesh = tests::sphere(100);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{9, 9, 9}, {8, 8, 8}});
  const Contraction found = tests::Collapsing(tests::tile_of(mesh)).choose(first);
  EXPECT_EQ(found.deviation.mean_square, 0);
}

// ---- motion --------------------------------------------------------------------------------

TEST(MotionTest, IsHowFarTheCornersWent) {
  BuildTile tile = tests::tile_of(tests::open_grid(2, 1));
  tile.history.weights = {1, 2, 3, 4, 5, 6};
  Contraction contraction;
  contraction.parent_of = {0, 1, 2, 3, 4, 5};
  contraction.representatives.positions = tile.mesh.vertices.positions;
  contraction.representatives.positions[5].z = 0.5F;  // the corner of one triangle, or of two
  const Deviation deviation = motion_of(tile, contraction);
  EXPECT_FLOAT_EQ(deviation.interior, 0.5F);
  EXPECT_FLOAT_EQ(deviation.around[5], 0.5F);
  EXPECT_EQ(deviation.around[0], 0);
  EXPECT_EQ(deviation.lost, 0);
  EXPECT_DOUBLE_EQ(deviation.mean_square, 6 * 0.25 / 21);
}

TEST(MotionTest, GhostsStayAndBorderTrianglesAreNotInterior) {
  const BuildTile tile = tests::tile_of(tests::open_grid(2, 1), 1);
  Contraction contraction;
  contraction.parent_of = {0};
  contraction.representatives.positions = {{0, 0, 2}};
  const Deviation deviation = motion_of(tile, contraction);
  EXPECT_EQ(deviation.interior, 0);
  EXPECT_FLOAT_EQ(deviation.around[0], 2);
  EXPECT_EQ(deviation.lost, 0);
}

TEST(MotionTest, APieceInOnePlaceIsLost) {
  tests::TestMesh mesh = flag();
  mesh.triangles.back() = {4, 5, 4};
  mesh.positions.push_back({4, 0, 0});
  mesh.triangles.back() = {4, 6, 5};
  const BuildTile tile = tests::tile_of(mesh);
  Contraction contraction;
  contraction.parent_of = {0, 1, 2, 3, 4, 4, 4};
  contraction.representatives.positions.assign(mesh.positions.begin(), mesh.positions.begin() + 5);
  const Deviation deviation = motion_of(tile, contraction);
  EXPECT_FLOAT_EQ(deviation.around[4], 1);
  // By (3, 0, 0), (3, 1, 0), (4, 0, 0).
  EXPECT_DOUBLE_EQ(deviation.mean_square * 7, 4 + 5 + 9);
  EXPECT_FLOAT_EQ(deviation.lost, 3);  // to (1, 0, 0), and once more as far as its corners went
  expect_deviation_holds(tile, {contraction.parent_of, contraction.representatives, deviation, {}});
}

TEST(MotionTest, NothingDrawnIsInfinitelyFar) {
  const BuildTile tile = tests::tile_of(flag());
  Contraction contraction;
  contraction.parent_of = {0, 0, 0, 0, 0, 0};
  contraction.representatives.positions = {{0, 0, 0}};
  EXPECT_TRUE(std::isinf(motion_of(tile, contraction).lost));
  EXPECT_TRUE(std::isinf(motion_of(tile, contraction).mean_square));
}

TEST(MotionTest, ABridgeThatIsDrawnNoMoreIsAsFarAsItsMiddle) {
  // Two squares far apart, and between them a strip whose vertices go half to one, half to the
  // other.
  tests::TestMesh mesh;
  tests::append(mesh, tests::open_grid(1, 1));
  tests::append(mesh, tests::open_grid(1, 1), {11, 0, 0});
  mesh.triangles.push_back({1, 4, 3});
  mesh.triangles.push_back({3, 4, 6});
  const BuildTile tile = tests::tile_of(mesh);
  Contraction contraction;
  contraction.parent_of = {0, 1, 2, 1, 3, 4, 3, 5};
  contraction.representatives.positions = {mesh.positions[0], mesh.positions[1], mesh.positions[2],
                                           mesh.positions[4], mesh.positions[5], mesh.positions[7]};
  const Deviation deviation = motion_of(tile, contraction);
  expect_deviation_holds(tile, {contraction.parent_of, contraction.representatives, deviation, {}});
}

}  // namespace
}  // namespace meshhier::cluster_simplify
