#include "render/plan_raster.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

constexpr std::uint32_t kPlanSide = 40;

/// A grid of vertices in the middles of pixels, with any heights.
PlanMesh grid_of_heights(std::uint32_t side, double first, double step) {
  std::mt19937 random(3);
  PlanMesh mesh;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x)
      mesh.places.push_back({first + step * x, first + step * y,
                             static_cast<double>(static_cast<float>(random()) / 3e6F)});
  }
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = y * side + x;
      mesh.triangles.push_back({a, a + side, a + 1});
      mesh.triangles.push_back({a + 1, a + side, a + side + 1});
    }
  }
  return mesh;
}

/// A soup of triangles over and beyond the raster.
PlanMesh random_triangles(std::uint32_t seed, std::size_t count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-8, kPlanSide + 8), height(0, 10);
  PlanMesh mesh;
  for (std::uint32_t i = 0; i < 3 * count; ++i) {
    mesh.places.push_back({place(random), place(random), height(random)});
    mesh.lights.push_back({static_cast<float>(height(random) / 10), 0.5F, 0.25F});
  }
  for (std::uint32_t i = 0; i < count; ++i)
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  return mesh;
}

TEST(PlanRaster, VerticesInTheMiddlesOfPixelsKeepTheirHeights) {
  const PlanMesh mesh = grid_of_heights(kPlanSide, 0.5, 1);
  PlanRaster raster({0, 0, kPlanSide, kPlanSide}, false);
  raster.draw(mesh);
  for (std::size_t i = 0; i < mesh.places.size(); ++i)
    ASSERT_EQ(raster.heights()[i], static_cast<float>(mesh.places[i].z)) << i;
  EXPECT_TRUE(raster.colours().empty());
}

TEST(PlanRaster, ASurfaceHasNoHoles) {
  for (const double step : {0.37, 0.5, 1.9, 7.3}) {
    const auto side = static_cast<std::uint32_t>(kPlanSide / step) + 2;
    PlanRaster raster({0, 0, kPlanSide, kPlanSide}, true);
    raster.draw(grid_of_heights(side, 0, step));
    EXPECT_EQ(std::ranges::count(raster.heights(), PlanRaster::kNothing), 0) << step;
    for (std::size_t i = 3; i < raster.colours().size(); i += 4)
      ASSERT_EQ(raster.colours()[i], 255);
  }
}

TEST(PlanRaster, WindowsAreThoseOfTheWhole) {
  const PlanMesh mesh = random_triangles(1, 60);
  PlanRaster whole({0, 0, kPlanSide, kPlanSide}, true);
  whole.draw(mesh);
  for (const PlanWindow& window : {PlanWindow{0, 0, 7, 40}, {7, 13, 33, 20}, {39, 39, 1, 1}}) {
    PlanRaster part(window, true);
    part.draw(mesh);
    for (std::uint32_t y = 0; y < window.height; ++y) {
      for (std::uint32_t x = 0; x < window.width; ++x) {
        const std::size_t here = y * window.width + x,
                          there = (window.row + y) * kPlanSide + window.column + x;
        ASSERT_EQ(part.heights()[here], whole.heights()[there]);
        ASSERT_TRUE(std::equal(&part.colours()[4 * here], &part.colours()[4 * here] + 4,
                               &whole.colours()[4 * there]));
      }
    }
  }
}

/// By doubles and without the raster's grid.
TEST(PlanRaster, TheHighestSurfaceIsSeen) {
  const PlanMesh mesh = random_triangles(2, 25);
  PlanRaster raster({0, 0, kPlanSide, kPlanSide}, false);
  raster.draw(mesh);
  std::size_t apart = 0;
  for (std::uint32_t y = 0; y < kPlanSide; ++y) {
    for (std::uint32_t x = 0; x < kPlanSide; ++x) {
      double highest = PlanRaster::kNothing;
      for (const auto& t : mesh.triangles) {
        const Vec3d a = mesh.places[t[0]], b = mesh.places[t[1]], c = mesh.places[t[2]];
        const double px = x + 0.5, py = y + 0.5;
        const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        const double u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area;
        const double v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area;
        if (u >= 0 && v >= 0 && u + v <= 1)
          highest = std::max(highest, u * a.z + v * b.z + (1 - u - v) * c.z);
      }
      const double found = raster.heights()[y * kPlanSide + x];
      apart += found == highest || std::abs(found - highest) < 0.05 ? 0 : 1;
    }
  }
  EXPECT_LE(apart, 8) << "pixels at borders, as corners are snapped";
}

/// A square over four pixels with a picture of four texels.
PlanMesh textured_square(AlphaMode alpha) {
  images::Image picture(2, 2, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    picture.texels[4 * i] = static_cast<std::uint8_t>(50 * i);
    picture.texels[4 * i + 3] = i == 1 ? 0 : 255;
  }
  PlanMesh mesh;
  mesh.places = {{0, 0, 5}, {2, 0, 5}, {2, 2, 5}, {0, 2, 5}};
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.texture = std::make_unique<const MipTexture>(std::move(picture),
                                                    Wraps{Wrap::clamp, Wrap::clamp}, alpha);
  return mesh;
}

TEST(PlanRaster, TexelsOfAPixelsSizeComeOutAsTheyAre) {
  PlanRaster raster({0, 0, 2, 2}, true);
  raster.draw(textured_square(AlphaMode::opaque));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(raster.colours()[4 * i], 50 * i);
}

TEST(PlanRaster, WhatIsTransparentIsNotThere) {
  PlanRaster raster({0, 0, 2, 2}, true);
  raster.draw(textured_square(AlphaMode::mask));
  EXPECT_EQ(raster.heights()[0], 5);
  EXPECT_EQ(raster.heights()[1], PlanRaster::kNothing);
  EXPECT_EQ(raster.colours()[7], 0);
}

TEST(PlanRaster, OfEqualHeightsTheFirstStays) {
  PlanMesh two = random_triangles(4, 2);
  two.places = {{-9, -9, 1}, {99, -9, 1}, {-9, 99, 1}, {-9, -9, 1}, {99, -9, 1}, {-9, 99, 1}};
  for (std::size_t i = 0; i < 6; ++i)
    two.lights[i] = i < 3 ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
  PlanRaster raster({0, 0, 4, 4}, true);
  raster.draw(two);
  EXPECT_EQ(raster.colours()[0], 255);
  EXPECT_EQ(raster.colours()[1], 0);
}

TEST(PlanRaster, PlacesThatAreNoNumbersDoNoHarm) {
  PlanMesh mesh = random_triangles(4, 3);
  mesh.places[0].x = std::nan("");
  mesh.places[4].y = 1e300;
  mesh.places[8].x = -INFINITY;
  PlanRaster raster({0, 0, 8, 8}, true);
  raster.draw(mesh);
}

}  // namespace
}  // namespace meshhier::render
