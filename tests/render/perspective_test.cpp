#include "render/perspective.h"

#include "tests/render/drawn.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

constexpr Framing kFraming{.width = 64, .height = 48, .samples = 2};
const Pose kPose{{1, 2, 5}, {0.5, 0, -1}};
const double kHalf = std::tan(kViewAngle / 2);

/// Where a camera without tricks has a point, in samples.
Vec3d pinhole(const Pose& pose, Vec3d p) {
  const ViewAxes axes = axes_of({pose.target - pose.position, {0, 1, 0}});
  const Vec3d from = p - pose.position;
  const double scale = kFraming.height * kFraming.samples / (2 * kHalf) / -dot(axes.back, from);
  return {kFraming.width * kFraming.samples / 2.0 + dot(axes.right, from) * scale,
          kFraming.height * kFraming.samples / 2.0 - dot(axes.up, from) * scale,
          -dot(axes.back, from)};
}

SceneTile tile_of(const Facet& facet) {
  SceneTile tile;
  tile.facets = {facet};
  return tile;
}

double side(Vec3d a, Vec3d b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

TEST(Perspective, CoversWhatAPinholeCameraDoes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> draw(-1.5F, 1.5F);
  const Perspective perspective(kPose, kFraming);
  for (int round = 0; round < 200; ++round) {
    const auto point = [&] { return Vec3f{draw(random), draw(random), draw(random) * 2}; };
    const Facet facet = flat_facet(point(), point(), point());
    SceneTile tile = tile_of(facet);
    perspective.project(tile);
    Raster raster(perspective.camera());
    raster.draw(tile.facets);
    std::array<Vec3d, 3> seen;
    for (std::size_t k = 0; k < 3; ++k)
      seen[k] = pinhole(kPose, to_double(facet[k].position));
    for (std::uint32_t i = 0; i < raster.samples().size(); ++i) {
      const double x = i % raster.columns() + 0.5, y = i / raster.columns() + 0.5;
      const double a = side(seen[0], seen[1], x, y), b = side(seen[1], seen[2], x, y),
                   c = side(seen[2], seen[0], x, y);
      const bool is_inside = (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
      const double nearest_edge = std::min({std::abs(a) / length(seen[1] - seen[0]),
                                            std::abs(b) / length(seen[2] - seen[1]),
                                            std::abs(c) / length(seen[0] - seen[2])});
      if (nearest_edge > 0.02) {
        EXPECT_EQ(raster.samples()[i].covered(), is_inside) << round << ' ' << x << ' ' << y;
      }
    }
  }
}

TEST(Perspective, HidesWhatIsBehind) {
  const Perspective perspective({{0, 0, 10}, {0, 0, 0}}, kFraming);
  for (const bool is_first : {false, true}) {
    SceneTile tile;
    const Facet near = flat_facet({-1, -1, 1}, {1, -1, 1}, {0, 1, 1});
    Facet far = flat_facet({-9, -9, -3}, {9, -9, -3}, {0, 9, -3});
    for (FacetCorner& corner : far)
      corner.colour = {1, 0, 0};
    tile.facets = is_first ? std::vector{near, far} : std::vector{far, near};
    perspective.project(tile);
    Raster raster(perspective.camera());
    raster.draw(tile.facets);
    const std::size_t middle = raster.samples().size() / 2 + raster.columns() / 2;
    EXPECT_EQ(raster.samples()[middle].colour, kPlainColour);
  }
}

TEST(Perspective, MixesColoursAsTheyLieInSpace) {
  // A floor that leads away: its colour is its depth.
  const Pose pose{{0, 1, 0}, {0, 0.5, -4}};
  Facet floor = flat_facet({-40, 0, -1}, {40, 0, -1}, {0, 0, -41});
  for (FacetCorner& corner : floor)
    corner.colour = {(-corner.position.z - 1) / 40, 0, 0};
  const Perspective perspective(pose, kFraming);
  SceneTile tile = tile_of(floor);
  perspective.project(tile);
  Raster raster(perspective.camera());
  raster.draw(tile.facets);
  for (const double z : {2.0, 4.0, 8.0, 15.0}) {
    const Vec3d seen = pinhole(pose, {0, 0, -z});
    const auto i =
        static_cast<std::size_t>(seen.y) * raster.columns() + static_cast<std::size_t>(seen.x);
    ASSERT_TRUE(raster.samples()[i].covered()) << z;
    EXPECT_NEAR(raster.samples()[i].colour.x, (z - 1) / 40, 0.04 * z / 8) << z;
  }
}

TEST(Perspective, LeavesOutWhatIsBehindTheEyeOrAside) {
  const Perspective perspective({{0, 0, 10}, {0, 0, 0}}, kFraming);
  SceneTile tile;
  tile.facets = {flat_facet({-1, -1, 11}, {1, -1, 11}, {0, 1, 20}),
                 flat_facet({100, 0, 0}, {101, 0, 0}, {100, 1, 0})};
  EXPECT_FALSE(perspective.sees({{-1, -1, 11}, {1, 1, 20}}));
  EXPECT_FALSE(perspective.sees({{100, 0, 0}, {101, 1, 0}}));
  EXPECT_TRUE(perspective.sees({{-100, -100, -100}, {100, 100, 100}}));
  perspective.project(tile);
  EXPECT_TRUE(tile.facets.empty());
}

TEST(FrameWhole, LeavesAsMuchRoomOnTheOneSideAsOnTheOther) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> draw(-1, 1);
  std::vector<Vec3d> points;
  BoundsD box;
  for (int i = 0; i < 500; ++i) {
    points.push_back({3 * draw(random) + 7, draw(random), 2 * draw(random)});
    box.add(points.back());
  }
  const double aspect = double{kFraming.width} / kFraming.height;
  const Pose pose = frame_whole(silhouette_of(points), box, std::nullopt, aspect);
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const Vec3d& point : points) {
    const Vec3d seen = pinhole(pose, point);
    left = std::min(left, seen.x);
    right = std::max(right, seen.x);
    top = std::min(top, seen.y);
    bottom = std::max(bottom, seen.y);
  }
  const double columns = kFraming.width * kFraming.samples;
  const double rows = kFraming.height * kFraming.samples;
  EXPECT_NEAR(left, columns - right, 3);
  EXPECT_NEAR(top, rows - bottom, 3);
  EXPECT_GT(left, 0);
  EXPECT_GT(top, 0);
  EXPECT_LT(std::min(left / columns, top / rows), 0.06);
}

}  // namespace
}  // namespace meshhier::render
