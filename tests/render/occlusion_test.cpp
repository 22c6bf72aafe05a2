#include "render/occlusion.h"

#include "render/shade.h"
#include "tests/render/drawn.h"

#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

constexpr std::uint32_t kGrid = 64;

/// Covers the whole grid at a height.
Facet floor_at(float z, float left = -400) {
  return flat_facet({left, -400, z}, {400, -400, z}, {left, 2000, z});
}

double sky_at(const Occlusion& occlusion, double column) {
  return occlusion.sky_at((column + 0.5) / kGrid, 0.5);
}

TEST(OcclusionTest, AFlatFloorAndAnEvenSlopeSeeAllOfTheSky) {
  for (const float slope : {0.0F, 0.5F, -1.5F}) {
    const Facet facet = flat_facet({-100, -400, -100 * slope}, {200, -400, 200 * slope},
                                   {-100, 2000, -100 * slope});
    const Occlusion occlusion(drawn(square_camera(kGrid), {facet}), 1);
    for (const double column : {1.0, 20.0, 62.0})
      EXPECT_GT(sky_at(occlusion, column), 0.97) << slope << " " << column;
  }
}

TEST(OcclusionTest, AFloorIsDarkBesideAStepAndTheStepIsNot) {
  // On the right half another floor, higher by four samples.
  const Occlusion occlusion(drawn(square_camera(kGrid), {floor_at(0), floor_at(4, 32)}), 1);
  EXPECT_GT(sky_at(occlusion, 4), 0.97);
  EXPECT_LT(sky_at(occlusion, 30), 0.8);
  EXPECT_LT(sky_at(occlusion, 30), sky_at(occlusion, 27));
  EXPECT_GT(sky_at(occlusion, 34), 0.97);
}

TEST(OcclusionTest, ReliefMakesTheStepHigher) {
  const Raster raster = drawn(square_camera(kGrid), {floor_at(0), floor_at(1, 32)});
  EXPECT_LT(sky_at(Occlusion(raster, 4), 30), sky_at(Occlusion(raster, 1), 30) - 0.05);
}

TEST(OcclusionTest, WhatIsFarInFrontDarkensNothing) {
  const Occlusion occlusion(drawn(square_camera(kGrid), {floor_at(0), floor_at(60, 32)}), 1);
  EXPECT_GT(sky_at(occlusion, 30), 0.97);
}

TEST(OcclusionTest, ThePictureOfAHollowIsDarker) {
  const Raster raster = drawn(square_camera(kGrid), {floor_at(0), floor_at(4, 32)});
  const Occlusion occlusion(raster, 1);
  for (const Light light : {Light::lamps, Light::none}) {
    const images::Image bare = shade(raster, {.kind = light});
    const images::Image shaded = shade(raster, {.kind = light, .occlusion = &occlusion});
    EXPECT_LT(shaded.at(30, 32)[0], bare.at(30, 32)[0]);
    EXPECT_NEAR(shaded.at(4, 32)[0], bare.at(4, 32)[0], 3);
  }
}

}  // namespace
}  // namespace meshhier::render
