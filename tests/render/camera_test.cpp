#include "render/camera.h"

#include "render/directions.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

std::vector<Vec3f> corners_of(const BoundsD& box) {
  std::vector<Vec3f> corners;
  for (const double x : {box.min.x, box.max.x}) {
    for (const double y : {box.min.y, box.max.y}) {
      for (const double z : {box.min.z, box.max.z})
        corners.push_back(to_float(Vec3d{x, y, z}));
    }
  }
  return corners;
}

/// Returns the bounds of a box's corners on the grid.
BoundsD shown(const Camera& camera, const BoundsD& box) {
  BoundsD bounds;
  for (const Vec3f corner : corners_of(box))
    bounds.add(camera.on_grid(corner));
  return bounds;
}

TEST(CameraTest, TheWholeBoxIsShownAsLargeAsTheFrameTakesIt) {
  const BoundsD box{{-3, 10, 2}, {5, 11, 6}};
  const Framing framing{.width = 300, .height = 200, .samples = 3, .margin = 0.1};
  constexpr double kMargin = 0.1 * 600;
  for (const View& view : views_around(40, {0, 0, 1})) {
    const Camera camera(view, box, framing);
    const BoundsD bounds = shown(camera, box);
    ASSERT_GE(bounds.min.x, kMargin - 1e-3);
    ASSERT_GE(bounds.min.y, kMargin - 1e-3);
    ASSERT_LE(bounds.max.x, 900 - kMargin + 1e-3);
    ASSERT_LE(bounds.max.y, 600 - kMargin + 1e-3);
    ASSERT_NEAR(std::min(bounds.min.x, bounds.min.y), kMargin, 1e-3);
    ASSERT_NEAR(bounds.min.x + bounds.max.x, 900, 1e-3);
    ASSERT_NEAR(bounds.min.y + bounds.max.y, 600, 1e-3);
  }
}

TEST(CameraTest, UpIsUpAndNearIsLess) {
  const BoundsD box{{-1, -1, -1}, {1, 1, 1}};
  const Camera camera(View{{0, 1, 0}, {0, 0, 1}}, box, {});
  const Vec3d middle = camera.on_grid({0, 0, 0});
  EXPECT_LT(camera.on_grid({0, 0, 1}).y, middle.y);
  EXPECT_GT(camera.on_grid({1, 0, 0}).x, middle.x);
  EXPECT_GT(camera.on_grid({0, 1, 0}).z, middle.z);
  EXPECT_EQ(camera.turned({1, 0, 0}), (Vec3f{1, 0, 0}));
  EXPECT_EQ(camera.turned({0, 0, 1}), (Vec3f{0, 1, 0}));
  EXPECT_EQ(camera.turned({0, -1, 0}), (Vec3f{0, 0, 1}));
}

TEST(CameraTest, AnUpAlongTheViewIsReplaced) {
  for (const Vec3d up : {Vec3d{1, 2, 3}, Vec3d{-1, -2, -3}, Vec3d{0, 0, 0}}) {
    const BoundsD box{{-1, -1, -1}, {1, 1, 1}};
    const Vec3d place = Camera(View{{1, 2, 3}, up}, box, {}).on_grid({1, -1, 0.5F});
    EXPECT_TRUE(std::isfinite(place.x) && std::isfinite(place.y) && std::isfinite(place.z));
  }
}

TEST(CameraTest, BoxesWithoutAnExtentAreInTheMiddle) {
  const BoundsD point{{4, 4, 4}, {4, 4, 4}}, line{{4, 4, 0}, {4, 4, 8}};
  for (const BoundsD& box : {point, line}) {
    const Vec3d place = Camera(View{}, box, {}).on_grid({4, 4, 4});
    EXPECT_EQ(place.x, 512);
    EXPECT_EQ(place.y, 512);
    EXPECT_EQ(place.z, 0);
  }
}

TEST(ViewsAroundTest, AreSpreadOverTheSphere) {
  for (const std::uint32_t count : {1U, 2U, 6U, 50U}) {
    const std::vector<View> views = views_around(count, {0, 1, 0});
    ASSERT_EQ(views.size(), count);
    double nearest = 2;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NEAR(length(views[i].direction), 1, 1e-12);
      for (std::size_t j = 0; j < i; ++j)
        nearest = std::min(nearest, length(views[i].direction - views[j].direction));
    }
    // Distances reach most of those in the best arrangement of many, sqrt(8 pi / (sqrt(3) n)).
    EXPECT_GT(nearest, 0.7 * std::min(2.0, std::sqrt(14.5 / count))) << count;
  }
}

TEST(CameraTest, APixelIsAsLargeAsItIsToBe) {
  const Camera camera(View{}, {10, 20, 30}, 0.5,
                      Framing{.width = 8, .height = 4, .samples = 3, .margin = 0.4});
  EXPECT_EQ(camera.on_grid({10, 20, 30}), (Vec3d{12, 6, 0}));
  EXPECT_EQ(camera.on_grid({10.5F, 20, 30}), (Vec3d{15, 6, 0}));
  EXPECT_EQ(camera.on_grid({10, 20.5F, 29}), (Vec3d{12, 3, 6}));
}

TEST(CameraTest, ABoxReachesAsFarAsItsCorners) {
  const BoundsD box{{0, 0, 0}, {1, 2, 3}};
  const ViewExtent front = extent_of(box, axes_of(View{}));
  EXPECT_EQ(front.across, 1);
  EXPECT_EQ(front.upright, 2);
  const ViewExtent side = extent_of(box, axes_of(View{{-1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(side.across, 3);
}

}  // namespace
}  // namespace meshhier::render
