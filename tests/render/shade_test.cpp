#include "render/shade.h"

#include "render/directions.h"
#include "render/png.h"
#include "render/srgb.h"
#include "tests/render/drawn.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

namespace meshhier::render {
namespace {

using Pixel = std::array<int, 4>;

Pixel pixel(const Picture& picture, std::size_t column, std::size_t row) {
  const std::uint8_t* p = picture.rgba.data() + 4 * (row * picture.width + column);
  return {p[0], p[1], p[2], p[3]};
}

/// FNV-1a.
std::uint64_t hash_of(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::byte byte : bytes)
    hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3;
  return hash;
}

/// Of a soup, whose making takes no function of the C library.
Raster soup_raster(const View& view) {
  const Camera camera(view, BoundsD{{-1, -1, -1}, {1, 1, 1}}, Framing{.width = 96, .height = 64});
  return drawn(camera, facets_around_origin(tests::soup(3000)));
}

std::uint64_t soup_hash(const View& view) {
  const Raster raster = soup_raster(view);
  const Picture picture = shade(raster);
  return hash_of(std::as_bytes(raster.samples())) ^
         hash_of(std::as_bytes(std::span<const std::uint8_t>(picture.rgba)));
}

TEST(SrgbTest, AgreesWithTheStandard) {
  for (int value = 0; value < 256; ++value) {
    const double v = value / 255.0;
    const double light = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    ASSERT_NEAR(light_of(v), light, 1e-15) << value;
    ASSERT_EQ(screen_value(light), value);
    ASSERT_EQ(screen_value(light_of((value - 0.49) / 255)), value);
    ASSERT_EQ(screen_value(light_of((value + 0.49) / 255)), value);
  }
}

TEST(SrgbTest, WhatIsNoLightIsCut) {
  EXPECT_EQ(screen_value(-1), 0);
  EXPECT_EQ(screen_value(std::nan("")), 0);
  EXPECT_EQ(screen_value(2), 255);
  EXPECT_EQ(light_of(std::nan("")), 0);
  EXPECT_EQ(light_of(-3), 0);
  EXPECT_EQ(light_of(70000), 1);
}

TEST(ShadeTest, TheGroundIsTransparent) {
  const Picture picture = shade(Raster(square_camera(4, 2)));
  EXPECT_EQ(picture.rgba, std::vector<std::uint8_t>(64));
}

TEST(ShadeTest, PartsOfAPixelAreItsAlphaAndKeepTheirColour) {
  // Three columns of samples of eight.
  const std::vector<Facet> facets{flat_facet({0, -80, 0}, {1.5F, -80, 0}, {0, 800, 0}),
                                  flat_facet({1.5F, -80, 0}, {1.5F, 800, 0}, {0, 800, 0})};
  const Picture picture = shade(drawn(square_camera(4, 2), facets));
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
  const Picture picture = shade(drawn(square_camera(2, 2), facets));
  const double full = light_of(pixel(picture, 1, 0)[0] / 255.0);
  EXPECT_NEAR(pixel(picture, 0, 0)[0], screen_value(full / 2), 1);
  EXPECT_LT(pixel(picture, 0, 0)[0], pixel(picture, 1, 0)[0]);
}

TEST(ShadeTest, LightComesFromTheUpperLeftAndNothingIsBlackOrBurnt) {
  const auto shade_of = [](Vec3f normal) {
    Facet facet = flat_facet({-80, -80, 0}, {80, -80, 0}, {0, 800, 0});
    for (FacetCorner& corner : facet)
      corner.normal = normal;
    return pixel(shade(drawn(square_camera(1), {facet})), 0, 0)[1];
  };
  const int lit = shade_of({-0.5F, 0.6F, 0.6F}), dark = shade_of({0, -1, 0});
  EXPECT_GT(lit, shade_of({0, 0, 1}));
  EXPECT_GT(shade_of({0, 0, 1}), shade_of({0.7F, -0.7F, 0.1F}));
  EXPECT_LT(lit, 255);
  EXPECT_GT(dark, 40);
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
TEST(ShadeTest, PicturesAreThoseOfTheFirstVersion) {
  EXPECT_EQ(soup_hash(views_around(6, {0, 0, 1})[2]), 14667331569105988618U);
}

/// What libpng reads from a file.
Picture decoded(const std::vector<std::byte>& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, file.data(), file.size()), 0);
  EXPECT_EQ(image.format, PNG_FORMAT_RGBA);
  Picture picture{image.width, image.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  EXPECT_NE(png_image_finish_read(&image, nullptr, picture.rgba.data(), 0, nullptr), 0);
  return picture;
}

TEST(PngTest, HoldsThePicture) {
  const Picture picture = shade(soup_raster(View{}));
  const std::vector<std::byte> file = encode_png(picture);
  EXPECT_EQ(file, encode_png(picture));
  const Picture read = decoded(file);
  EXPECT_EQ(read.width, 96U);
  EXPECT_EQ(read.height, 64U);
  EXPECT_EQ(read.rgba, picture.rgba);
}

}  // namespace
}  // namespace meshhier::render
