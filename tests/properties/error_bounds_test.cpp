// Promise: no point of what a tile shows, and none of the original surface under it, is farther off
// than the tile's bound; and bounds say something.
#include "config/config.h"
#include "pipeline/build.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/simplify_methods.h"
#include "verify/verify_error.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

class ErrorBoundsTest : public testing::Test {
 protected:
  /// All levels of simplified tiles, measured.
  std::vector<verifying::ErrorMeasurement> measure(const tests::TestMesh& mesh,
                                                   const config::SimplifyConfig& simplify) {
    const fs::path input = directory_.path() / "mesh.ply";
    tests::write_ply(mesh, input);
    config::Config config = tests::quick_config();
    config.input = input;
    config.output = directory_.path() / "mesh.hier";
    config.partition.vertices = 150;
    config.simplify = simplify;
    config.simplify.vertices = 100;
    execution::NoProgress progress;
    const execution::CancelToken cancel;
    pipeline::build_hierarchy(config, {.force = true}, {*files_, progress, cancel});
    return verifying::measure_errors(*files_, config.output,
                                     {verifying::AllLevels{}, 20'000, 1U << 30}, progress, cancel);
  }

  static void expect_bounds_hold(const std::vector<verifying::ErrorMeasurement>& levels) {
    EXPECT_FALSE(levels.empty());
    for (const verifying::ErrorMeasurement& level : levels) {
      EXPECT_THAT(level.problems, IsEmpty()) << level.name;
      EXPECT_LE(level.bound, level.diagonal * 1.001) << level.name;
    }
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

/// A bumpy sheet with triangles that hang on single corners of it.
tests::TestMesh hung_on_corners() {
  tests::TestMesh mesh = tests::open_grid(25, 25, 0.2F);
  for (std::uint32_t v = 0; v < 600; v += 7) {
    const Vec3f at = mesh.positions[v];
    const auto next = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(at + Vec3f{0.3F, 0.1F, 2});
    mesh.positions.push_back(at + Vec3f{-0.1F, 0.3F, 2});
    mesh.triangles.push_back({v, next, next + 1});
  }
  return mesh;
}

/// A sheet with one vertex far above it, which spans nearly all of the area.
tests::TestMesh spike() {
  tests::TestMesh mesh = tests::open_grid(30, 30, 0.2F);
  mesh.positions[31 * 15 + 15].z = 1e6F;
  return mesh;
}

/// Each triangle twice, once reversed.
tests::TestMesh two_sided(tests::TestMesh mesh) {
  const std::vector<tests::MeshTriangle> one = mesh.triangles;
  for (const tests::MeshTriangle& t : one)
    mesh.triangles.push_back({t[0], t[2], t[1]});
  return mesh;
}

/// A sphere, and far away vertices that no triangle uses.
tests::TestMesh far_loose_vertices() {
  tests::TestMesh mesh = tests::sphere(1200, 0.01F);
  for (const float far : {1e9F, -1e9F, 1e30F})
    mesh.positions.insert(mesh.positions.begin() + 600, {far, far, far});
  for (tests::MeshTriangle& t : mesh.triangles) {
    for (std::uint32_t& v : t)
      v += v >= 600 ? 3 : 0;
  }
  return mesh;
}

std::vector<std::pair<std::string, tests::TestMesh>> meshes() {
  tests::TestMesh specks = tests::sphere(1200, 0.01F);
  append(specks, tests::soup(100), {0.5F, 0, 0}, 2);
  tests::TestMesh line = tests::open_grid(60, 5);
  for (Vec3f& p : line.positions)
    p = {p.x + p.y / 8, 0, 0};  // no two at one place
  return {{"torus", tests::torus(2400, 0.01F)},
          {"nested shells", tests::nested_shells(2000, 0.01F)},
          {"terrain", tests::open_grid(30, 30, 0.3F)},
          {"moebius", tests::moebius(1200, 0.01F)},
          {"soup", tests::soup(400)},
          {"non-manifold", tests::non_manifold(1500, 0.02F)},
          {"duplicates", tests::duplicates(1500, 0.01F)},
          {"specks", specks},
          {"hung on corners", hung_on_corners()},
          {"without area", line},
          {"two-sided terrain", two_sided(tests::open_grid(30, 30, 0.3F))},
          {"two-sided moebius", two_sided(tests::moebius(1200, 0.01F))},
          {"two-sided, non-manifold", two_sided(tests::non_manifold(900, 0.02F))},
          {"spike", spike()}};
}

TEST_F(ErrorBoundsTest, SLOW_NoSampleIsBeyondItsTilesBound) {
  for (const auto& [method, simplify] : tests::all_simplify_methods()) {
    for (const auto& [name, mesh] : meshes()) {
      SCOPED_TRACE(method + " of " + name);
      expect_bounds_hold(measure(mesh, simplify));
    }
  }
}

/// A cluster's mean is of all its vertices, and so may be far from the surface.
TEST_F(ErrorBoundsTest, FarLooseVerticesTakeNoDigitsFromCollapses) {
  for (const auto& [method, simplify] : tests::all_simplify_methods()) {
    if (simplify.method == config::SimplifyMethod::cluster)
      continue;
    SCOPED_TRACE(method);
    expect_bounds_hold(measure(far_loose_vertices(), simplify));
  }
}

/// On the finest simplified level, where both have about the same triangles.
TEST_F(ErrorBoundsTest, OfATwoSidedSheetTheyAreAsGoodAsOfOneSide) {
  for (const auto& [method, simplify] : tests::all_simplify_methods()) {
    // A cluster is not measured by triangles, and curvature is another one where two sides meet.
    if (simplify.method == config::SimplifyMethod::cluster ||
        simplify.cost == config::HalfEdgeCost::melax)
      continue;
    SCOPED_TRACE(method);
    const tests::TestMesh sheet = tests::open_grid(50, 50, 0.2F);
    const auto one = measure(sheet, simplify), both = measure(two_sided(sheet), simplify);
    ASSERT_EQ(one.size(), both.size());
    EXPECT_LE(both.back().bound, 1.5 * one.back().bound);
    EXPECT_LE(both.back().error, 1.2 * one.back().error);
  }
}

TEST_F(ErrorBoundsTest, BoundsOfASmoothTorusSaySomething) {
  for (const auto& [method, simplify] : tests::all_simplify_methods()) {
    SCOPED_TRACE(method);
    const auto levels = measure(tests::torus(6000), simplify);
    expect_bounds_hold(levels);
    for (const verifying::ErrorMeasurement& level : levels) {
      EXPECT_LE(level.bound, 20 * std::max(level.forward.max, level.backward.max)) << level.name;
    }
  }
}

}  // namespace
}  // namespace meshhier::pipeline
