#include "render/portrait.h"

#include "tests/render/drawn.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

std::vector<Facet> turned_up(std::vector<Facet> facets) {
  for (Facet& facet : facets) {
    for (FacetCorner& corner : facet)
      corner.position = {corner.position.x, corner.position.z, -corner.position.y};
  }
  return facets;
}

std::vector<Facet> stretched(std::vector<Facet> facets, float z) {
  for (Facet& facet : facets) {
    for (FacetCorner& corner : facet)
      corner.position.z *= z;
  }
  return facets;
}

View portrait_view(std::span<const Facet> facets, Vec3d up) {
  return view_from(portrait_from(facets, up), up);
}

void expect_near(Vec3d a, Vec3d b) {
  EXPECT_LT(length(a - b), 0.05) << a.x << " " << a.y << " " << a.z;
}

TEST(PortraitTest, TerrainIsLookedAtAsAMapIs) {
  const std::vector<Facet> flat =
      stretched(facets_around_origin(tests::open_grid(20, 20, 0.3F)), 0.1F);
  const View z_up = portrait_view(flat, {0, 0, 1});
  expect_near(z_up.direction, {0, 0, -1});
  expect_near(axes_of(z_up).right, {1, 0, 0});
  expect_near(axes_of(z_up).up, {0, 1, 0});
  const View y_up = portrait_view(turned_up(flat), {0, 1, 0});
  expect_near(y_up.direction, {0, -1, 0});
  expect_near(axes_of(y_up).right, {1, 0, 0});
}

TEST(PortraitTest, TheScanOfAFrontIsLookedAtFromItsFront) {
  const std::vector<Facet> flat = facets_around_origin(tests::open_grid(20, 20));
  expect_near(portrait_view(flat, {0, 1, 0}).direction, {0, 0, -1});
}

TEST(PortraitTest, AClosedModelIsSeenFromAboveAndBesideItsAxes) {
  for (const Vec3d up : {Vec3d{0, 1, 0}, Vec3d{0, 0, 5}}) {
    const View view = portrait_view(facets_around_origin(tests::torus(1000, 0.2F)), up);
    EXPECT_LT(dot(view.direction, up), 0);
    EXPECT_GT(std::abs(view.direction.x), 0.1);
    const double level = up.z > 0 ? view.direction.y : view.direction.z;
    EXPECT_GT(std::abs(level), 0.1);
  }
}

TEST(PortraitTest, TheModelFillsTheFrameAndNothingIsCutOff) {
  const std::vector<Facet> facets = facets_around_origin(tests::genus_n(2, 1000));
  const View view = portrait_view(facets, {0, 1, 0});
  const Framing framing{.width = 100, .height = 60, .samples = 2, .margin = 0.05};
  const Camera camera = portrait_camera(facets, view, framing);
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const Facet& facet : facets) {
    for (const FacetCorner& corner : facet) {
      const Vec3d p = camera.on_grid(corner.position);
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  }
  const double width = right - left, height = bottom - top;
  EXPECT_NEAR(std::max(width / 180, height / 108), 1, 1e-5);
  EXPECT_NEAR(left + right, 200, 1e-3);
  EXPECT_NEAR(top + bottom, 120, 1e-3);
}

TEST(PortraitTest, PointsAreLookedAtAsAMapIfTheyLieFlat) {
  std::vector<Facet> points;
  for (const Vec3f p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{1, 1, 0.1F}})
    points.push_back(flat_facet(p, p, p));
  EXPECT_EQ(portrait_from(points, {0, 0, 1}), (Standpoint{0, 90}));
  const Standpoint upright = portrait_from(points, {0, 1, 0});
  EXPECT_GT(upright.elevation, 0);
  EXPECT_LT(upright.elevation, 45);
}

TEST(PortraitTest, AnglesAreShortNumbers) {
  std::vector<Facet> facets = facets_around_origin(tests::open_grid(20, 20));
  for (Facet& facet : facets) {
    for (FacetCorner& corner : facet)
      corner.position.z += 0.3F * corner.position.x - 0.2F * corner.position.y;
  }
  const Standpoint from = portrait_from(facets, {0, 1, 0});
  EXPECT_EQ(from.azimuth * 4, std::floor(from.azimuth * 4));
  EXPECT_EQ(from.elevation * 4, std::floor(from.elevation * 4));
  EXPECT_NEAR(from.azimuth, 343, 5);
  EXPECT_NEAR(from.elevation, 11, 4);
}

TEST(PortraitTest, ModelsOfNothingHaveAView) {
  for (const std::vector<Facet>& facets :
       {std::vector<Facet>{}, {flat_facet({1, 2, 3}, {1, 2, 3}, {1, 2, 3})}}) {
    const View view = portrait_view(facets, {0, 1, 0});
    EXPECT_GT(length(view.direction), 0.9);
    const Vec3d place = portrait_camera(facets, view, {}).on_grid({1, 2, 3});
    EXPECT_TRUE(std::isfinite(place.x) && std::isfinite(place.y));
  }
}

}  // namespace
}  // namespace meshhier::render
