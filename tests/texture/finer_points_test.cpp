// Points of finer surfaces by drawing, against a search among all triangles.
#include "texture/finer_points.h"

#include "base/closest_point.h"
#include "tests/texture/painted.h"
#include "tests/texture/random_numbers.h"
#include "texture/vertex_feet.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

Vec3d corner(const Mesh& mesh, std::size_t triangle, std::size_t k) {
  return to_double(mesh.positions[raw(mesh.triangles[triangle][k])]);
}

TriangleFrame frame(const Mesh& mesh, std::size_t triangle) {
  return {corner(mesh, triangle, 0), corner(mesh, triangle, 1), corner(mesh, triangle, 2)};
}

double distance(const Mesh& mesh, const Vec3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    least = std::min(least, closest_point(point, frame(mesh, t)).squared_distance);
  return std::sqrt(least);
}

/// The tile's vertex that is nearest to each of the finer surface's: what a contraction says.
std::vector<std::uint32_t> beside(const Mesh& tile, const Mesh& finer) {
  std::vector<std::uint32_t> nearest;
  for (const Vec3f& at : finer.positions) {
    const auto off = [&](const Vec3f& other) { return length(to_double(at) - to_double(other)); };
    const auto found = std::ranges::min_element(tile.positions, {}, off);
    nearest.push_back(static_cast<std::uint32_t>(found - tile.positions.begin()));
  }
  return nearest;
}

TEST(VertexFeet, AreTheNearestPointsOfATile) {
  const Mesh tile = make_torus(30, 12, 0.01), finer = make_torus(90, 40, 0.01);
  const Faces faces = faces_of(tile.positions, tile.triangles);
  const FootFinder finder(tile.positions, tile.triangles, faces);
  const std::vector<VertexFoot> feet =
      feet_of(finder, finer.positions, finer.triangles, beside(tile, finer));
  ASSERT_EQ(feet.size(), finer.positions.size());
  std::size_t farther = 0;
  for (std::size_t v = 0; v < feet.size(); ++v) {
    const Vec3d at = to_double(finer.positions[v]);
    ASSERT_NE(feet[v].triangle, kNoFace);
    ASSERT_NEAR(closest_point(feet[v].point, frame(tile, feet[v].triangle)).squared_distance, 0,
                1e-12)
        << "a foot is in its triangle";
    farther += length(feet[v].point - at) > distance(tile, at) + 1e-6 ? 1 : 0;
  }
  EXPECT_LT(farther, feet.size() / 100);
}

TEST(VertexFeet, ThoseWithoutAStartTakeACornersOrHaveNone) {
  const Mesh tile = make_torus(12, 8);
  const Faces faces = faces_of(tile.positions, tile.triangles);
  const FootFinder finder(tile.positions, tile.triangles, faces);
  std::vector<std::uint32_t> start(tile.positions.size(), kNoVertex);
  const TileTriangle first = tile.triangles.front();
  start[raw(first[0])] = raw(first[0]);
  const std::vector<VertexFoot> feet = feet_of(finder, tile.positions, tile.triangles, start);
  for (const TileVertex v : first) {
    ASSERT_NE(feet[raw(v)].triangle, kNoFace);
    EXPECT_NEAR(length(feet[raw(v)].point - to_double(tile.positions[raw(v)])), 0, 1e-6);
  }
  const auto none = static_cast<std::size_t>(
      std::ranges::count(feet, kNoFace, [](const VertexFoot& foot) { return foot.triangle; }));
  EXPECT_GT(none, feet.size() / 2);
  for (const VertexFoot& foot : feet_of(finder, tile.positions, tile.triangles, {}))
    EXPECT_EQ(foot.triangle, kNoFace);
}

struct Distances {
  std::size_t texels = 0, farther = 0;
};

/// Compares the points of texels with the nearest ones.
Distances distances(const Mesh& tile, const Mesh& finer, std::span<const std::uint32_t> start) {
  const TexturedSurface surface{tile.positions, tile.triangles, {}, nullptr};
  const TexelSamples samples(surface, {128, 0});
  const FinerSurfaces surfaces({{finer.positions, finer.triangles, start}}, samples);
  const std::vector<FinerPoint> points = surfaces.points(samples);
  const double texel = 1 / samples.layout().density;
  Distances result;
  for (std::uint32_t y = 0; y < samples.layout().height; ++y) {
    for (std::uint32_t x = 0; x < samples.layout().width; ++x) {
      const FinerPoint& found = points[std::size_t{y} * samples.layout().width + x];
      if (samples.at(x, y).triangle == kNoFace) {
        EXPECT_EQ(found.triangle, FinerPoint::kNone) << "texels that show nothing are not asked";
        continue;
      }
      EXPECT_LT(found.triangle, finer.triangles.size());
      const Vec3d at = samples.point(samples.at(x, y));
      const Vec3d there = point_of(finer, found.triangle, double{found.on_b}, double{found.on_c});
      ++result.texels;
      result.farther += length(there - at) > distance(finer, at) + texel / 4 ? 1 : 0;
    }
  }
  return result;
}

TEST(FinerPoints, AreTheNearestHoweverTheyAreFound) {
  const Mesh tile = make_torus(24, 10), finer = make_torus(70, 30, 0.01);
  const std::vector<std::uint32_t> start = beside(tile, finer);
  const Distances drawn = distances(tile, finer, start), searched = distances(tile, finer, {});
  EXPECT_GT(drawn.texels, 4000U);
  EXPECT_EQ(drawn.texels, searched.texels);
  EXPECT_LT(drawn.farther, drawn.texels / 50) << "by more than a quarter of a texel";
  EXPECT_LT(searched.farther, drawn.texels / 200) << "those that face alike come first";
}

TEST(FinerPoints, WrongStartsOnlyCostTime) {
  const Mesh tile = make_torus(24, 10), finer = make_torus(70, 30);
  RandomNumbers random(7);
  std::vector<std::uint32_t> start(finer.positions.size());
  for (std::uint32_t& vertex : start)
    vertex = static_cast<std::uint32_t>(random.part() * double(tile.positions.size() - 1));
  const Distances found = distances(tile, finer, start);
  EXPECT_LT(found.farther, found.texels / 20);
}

TEST(FinerPoints, NothingFinerShowsNothing) {
  const Mesh tile = make_torus(8, 6);
  const TexturedSurface surface{tile.positions, tile.triangles, {}, nullptr};
  const TexelSamples samples(surface, {64, 0});
  for (const FinerPoint& point : FinerSurfaces({}, samples).points(samples))
    ASSERT_EQ(point.triangle, FinerPoint::kNone);
}

}  // namespace
}  // namespace meshhier::texture
