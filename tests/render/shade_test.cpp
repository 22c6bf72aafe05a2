#include "render/shade.h"

#include "base/srgb.h"
#include "render/directions.h"
#include "tests/render/drawn.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

using images::Image;
using Pixel = std::array<int, 4>;

Pixel pixel(const Image& picture, std::size_t column, std::size_t row) {
  const std::uint8_t* p = picture.texels.data() + 4 * (row * picture.width + column);
  return {p[0], p[1], p[2], p[3]};
}

/// FNV-1a.
std::uint64_t hash_of(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::byte byte : bytes)
    hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3;
  return hash;
}

/// Draws a soup, whose making takes no function of the C library.
Raster soup_raster(const View& view) {
  const Camera camera(view, BoundsD{{-1, -1, -1}, {1, 1, 1}}, Framing{.width = 96, .height = 64});
  return drawn(camera, facets_around_origin(tests::soup(3000)));
}

std::uint64_t soup_hash(const View& view) {
  const Raster raster = soup_raster(view);
  const Image picture = shade(raster);
  return hash_of(std::as_bytes(raster.samples())) ^
         hash_of(std::as_bytes(std::span<const std::uint8_t>(picture.texels)));
}

TEST(ShadeTest, TheGroundIsTransparent) {
  const Image picture = shade(Raster(square_camera(4, 2)));
  EXPECT_EQ(picture.texels, std::vector<std::uint8_t>(64));
}

TEST(ShadeTest, PartsOfAPixelAreItsAlphaAndKeepTheirColour) {
  // Three columns of samples of eight.
  const std::vector<Facet> facets{flat_facet({0, -80, 0}, {1.5F, -80, 0}, {0, 800, 0}),
                                  flat_facet({1.5F, -80, 0}, {1.5F, 800, 0}, {0, 800, 0})};
  const Image picture = shade(drawn(square_camera(4, 2), facets));
  EXPECT_EQ(pixel(picture, 0, 1)[3], 255);
  EXPECT_EQ(pixel(picture, 1, 1)[3], 128);
  EXPECT_EQ(pixel(picture, 2, 1), (Pixel{0, 0, 0, 0}));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(pixel(picture, 1, 1)[i], pixel(picture, 0, 1)[i]);
}

TEST(ShadeTest, SamplesAreAveragedAsLight) {
  std::vector<Facet> facets{flat_facet({-80, -80, 0}, {80, -80, 0}, {0, 800, 0}),
                            flat_facet({-80, -80, 1}, {0.5F, -80, 1}, {0.5F, 800, 1})};
  for (FacetCorner& corner : facets[1])
    corner.colour = {};
  const Image picture = shade(drawn(square_camera(2, 2), facets), {.kind = Light::none});
  const double full = light_of(pixel(picture, 1, 0)[0] / 255.0);
  EXPECT_NEAR(pixel(picture, 0, 0)[0], screen_value(full / 2), 1);
  EXPECT_LT(pixel(picture, 0, 0)[0], pixel(picture, 1, 0)[0]);
}

/// Returns the pixel of a facet across the view, but with that normal.
Pixel shade_of(Vec3f normal, const Lighting& lighting = {}) {
  Facet facet = flat_facet({-80, -80, 0}, {80, -80, 0}, {0, 800, 0});
  for (FacetCorner& corner : facet)
    corner.normal = normal;
  return pixel(shade(drawn(square_camera(1), {facet}), lighting), 0, 0);
}

TEST(ShadeTest, LightComesFromTheUpperLeftAndNothingIsBlackOrBurnt) {
  const int lit = shade_of({-0.5F, 0.6F, 0.6F})[1], dark = shade_of({0, -1, 0})[1];
  EXPECT_GT(lit, shade_of({0, 0, 1})[1]);
  EXPECT_GT(shade_of({0, 0, 1})[1], shade_of({0.7F, -0.7F, 0.1F})[1]);
  EXPECT_LT(lit, 255);
  EXPECT_GT(dark, 40);
}

/// The expected values are those of three (r187) for a ball of the plain colour in the viewer's
/// studio, drawn without perspective, where it faces these ways.
TEST(ShadeTest, ASurfaceIsLitAsTheViewerLightsIt) {
  const std::array<std::pair<Vec3f, std::array<int, 3>>, 5> expected{{
      {{0, 0, 1}, {160, 150, 137}},
      {{-0.48F, 0.64F, 0.6F}, {197, 186, 169}},
      {{0.6F, 0, 0.8F}, {116, 111, 106}},
      {{0, -0.8F, 0.6F}, {67, 58, 48}},
      {{0.8F, 0.48F, 0.36F}, {139, 139, 141}},
  }};
  for (const auto& [normal, colour] : expected) {
    const Pixel shown = shade_of(normal);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(shown[i], colour[i], 1) << normal.x << " " << normal.y;
  }
}

TEST(ShadeTest, WhatIsTooBrightKeepsItsHue) {
  for (const double light : {0.0, 0.02, 0.3, 0.75})
    EXPECT_NEAR(toned({light, light, light}).x, light < 0.08 ? 6.25 * light * light : light - 0.04,
                1e-12);
  const Vec3d bright = toned({8, 4, 2});
  EXPECT_LT(bright.x, 1);
  EXPECT_GT(bright.x, bright.y);
  EXPECT_GT(bright.y, bright.z);
}

TEST(ShadeTest, HollowsAreDarkerAndEdgesLighter) {
  // Normals turn from the left to the right: away from each other over an edge.
  const auto brightness = [](float turn) {
    Facet facet = flat_facet({-80, -80, 0}, {80, -80, 0}, {0, 800, 0});
    const auto lean = [&](float x) { return Vec3f{turn * x, 0, 1}; };
    for (FacetCorner& corner : facet)
      corner.normal = lean(corner.position.x);
    return pixel(shade(drawn(square_camera(1, 2), {facet})), 0, 0)[1];
  };
  EXPECT_GT(brightness(0.1F), brightness(0) + 5);
  EXPECT_LT(brightness(-0.1F), brightness(0) - 5);
}

TEST(ShadeTest, ColoursWithTheirOwnLightStay) {
  for (const Vec3f normal : {Vec3f{0, 0, 1}, Vec3f{0, -1, 0}})
    EXPECT_EQ(shade_of(normal, {.kind = Light::none}), (Pixel{0xb9, 0xb4, 0xab, 255}));
}

TEST(ShadeTest, PicturesAreEqualToTheByteInAllThreads) {
  const View view{{-1, -2, -3}, {0, 0, 1}};
  std::array<std::uint64_t, 4> hashes{};
  std::vector<std::thread> threads;
  for (std::uint64_t& hash : hashes)
    threads.emplace_back([&hash, &view] { hash = soup_hash(view); });
  for (std::thread& thread : threads)
    thread.join();
  for (const std::uint64_t hash : hashes)
    EXPECT_EQ(hash, soup_hash(view));
}

/// The bytes are the same on every processor and by every compiler.
TEST(ShadeTest, PicturesAreThoseOfBefore) {
  EXPECT_EQ(soup_hash(views_around(6, {0, 0, 1})[2]), 10538107124586289550U);
}

}  // namespace
}  // namespace meshhier::render
