// Textures, looked up and drawn.
#include "render/mip_texture.h"

#include "base/srgb.h"
#include "render/shade.h"
#include "tests/render/drawn.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

/// Squares of `square` texels, black and white, white in the upper left corner.
images::Image checker(std::uint32_t side, std::uint32_t square) {
  images::Image image(side, side, 3);
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      for (std::uint32_t c = 0; c < 3; ++c)
        image.at(x, y)[c] = (x / square + y / square) % 2 == 0 ? 255 : 0;
    }
  }
  return image;
}

/// One row: red of each texel.
images::Image reds(const std::vector<std::uint8_t>& values) {
  images::Image image(static_cast<std::uint32_t>(values.size()), 1, 3);
  for (std::uint32_t x = 0; x < image.width; ++x)
    image.at(x, 0)[0] = values[x];
  return image;
}

/// [0, size] x [0, size], two facets, with the whole texture upright on them.
void draw_square(Raster& raster, float size, const MipTexture& texture) {
  const Facet lower = flat_facet({0, 0, 0}, {size, 0, 0}, {size, size, 0});
  const Facet upper = flat_facet({0, 0, 0}, {size, size, 0}, {0, size, 0});
  raster.draw(lower, {&texture, {Vec2f{0, 1}, {1, 1}, {1, 0}}});
  raster.draw(upper, {&texture, {Vec2f{0, 1}, {1, 0}, {0, 0}}});
}

images::Image drawn_square(std::uint32_t size, std::uint32_t samples, const MipTexture& texture) {
  Raster raster(square_camera(size, samples));
  draw_square(raster, static_cast<float>(size), texture);
  return shade(raster, {.kind = Light::none});
}

// ---- lookups -------------------------------------------------------------------------------

TEST(MipTextureTest, MiddlesOfTexelsShowThem) {
  const MipTexture texture(reds({0, 100, 200, 255}));
  for (std::uint32_t x = 0; x < 4; ++x) {
    const Vec3f light = texture.light_at({(static_cast<float>(x) + 0.5F) / 4, 0.5F}, 0);
    EXPECT_EQ(screen_value(light.x), (std::array{0, 100, 200, 255})[x]);
    EXPECT_EQ(light.y, 0);
  }
}

TEST(MipTextureTest, BetweenTexelsLightIsMixedNotNumbers) {
  const MipTexture texture(reds({0, 255}), {Wrap::clamp, Wrap::clamp});
  EXPECT_FLOAT_EQ(texture.light_at({0.5F, 0}, 0).x, 0.5F);
  EXPECT_FLOAT_EQ(texture.light_at({0.375F, 0}, 0).x, 0.25F);
}

TEST(MipTextureTest, LevelsAreMeansAndMixedBetween) {
  const MipTexture texture(reds({255, 255, 0, 0}), {Wrap::clamp, Wrap::clamp});
  EXPECT_FLOAT_EQ(texture.light_at({0.125F, 0}, 1).x, 1);
  EXPECT_NEAR(texture.light_at({0.125F, 0}, 2).x, 0.5, 0.005);
  EXPECT_NEAR(texture.light_at({0.125F, 0}, 1.5).x, 0.75, 0.005);
  EXPECT_NEAR(texture.light_at({0.125F, 0}, 99).x, 0.5, 0.005);
}

TEST(MipTextureTest, WrapsAsItsMaterialSays) {
  const images::Image image = reds({0, 100, 200, 255});
  const auto value = [&](Wrap wrap, float u) {
    return int{screen_value(MipTexture(image, {wrap, wrap}).light_at({u, 0.5F}, 0).x)};
  };
  EXPECT_EQ(value(Wrap::repeat, 1.375F), 100);
  EXPECT_EQ(value(Wrap::repeat, -0.875F), 0);
  EXPECT_EQ(value(Wrap::mirrored, 1.375F), 200);
  EXPECT_EQ(value(Wrap::mirrored, -0.375F), 100);
  EXPECT_EQ(value(Wrap::mirrored, 2.375F), 100);
  EXPECT_EQ(value(Wrap::clamp, 7), 255);
  EXPECT_EQ(value(Wrap::clamp, -7), 0);
  // At the border, the texel beyond it is half of what is seen.
  EXPECT_FLOAT_EQ(MipTexture(image).light_at({0, 0.5F}, 0).x, 0.5F);
  EXPECT_EQ(value(Wrap::mirrored, 0), 0);
}

TEST(MipTextureTest, WhatIsNoNumberIsNoHarm) {
  const MipTexture texture(reds({0, 255}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(texture.light_at({nan, nan}, nan), texture.light_at({0, 0}, 0));
  EXPECT_EQ(texture.light_at({1e30F, 0}, -5), texture.light_at({0, 0}, 0));
}

TEST(MipTextureTest, LevelsFollowTheAreaOfASample) {
  EXPECT_EQ(level_for(0), 0);
  EXPECT_EQ(level_for(1), 0);
  EXPECT_EQ(level_for(4), 1);
  EXPECT_EQ(level_for(64), 3);
  EXPECT_NEAR(level_for(8), 1.5, 1e-12);
  EXPECT_NEAR(level_for(100), 0.5 * std::log2(100), 0.05);
  EXPECT_EQ(level_for(std::numeric_limits<double>::infinity()), 0);
}

// ---- drawn ---------------------------------------------------------------------------------

TEST(TexturedRasterTest, ATexelAPixelIsThePictureItself) {
  const images::Image image = checker(64, 4);
  const images::Image picture = drawn_square(64, 1, MipTexture(image));
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      ASSERT_EQ(picture.at(x, y)[0], image.at(x, y)[0]) << x << " " << y;
      ASSERT_EQ(picture.at(x, y)[3], 255);
    }
  }
}

/// The share of [left, left + 1] that is white, of stripes of that width from 0 on.
double white_between(double left, double width) {
  constexpr int kSteps = 1000;
  int white = 0;
  for (int i = 0; i < kSteps; ++i)
    white += static_cast<int>((left + (i + 0.5) / kSteps) / width) % 2 == 0 ? 1 : 0;
  return static_cast<double>(white) / kSteps;
}

TEST(TexturedRasterTest, ACheckerIsItsCoverageAtEachScale) {
  const MipTexture texture(checker(256, 16));
  for (const std::uint32_t size : {256U, 200U, 128U, 100U, 64U, 48U}) {
    const images::Image picture = drawn_square(size, 2, texture);
    const double square = 16.0 * size / 256;
    double off = 0;
    for (std::uint32_t y = 0; y < size; ++y) {
      for (std::uint32_t x = 0; x < size; ++x) {
        const double across = white_between(x, square), down = white_between(y, square);
        const double white = across * down + (1 - across) * (1 - down);
        off += std::abs(light_of(picture.at(x, y)[0] / 255.0) - white);
      }
    }
    // Pixels along edges differ: filters are wider than a pixel.
    EXPECT_LT(off / (size * size), 0.6 / square) << size;
  }
}

TEST(TexturedRasterTest, FarAwayACheckerIsHalfTheLight) {
  const MipTexture texture(checker(256, 2));
  for (const std::uint32_t size : {16U, 23U, 31U}) {
    const images::Image picture = drawn_square(size, 2, texture);
    for (std::uint32_t i = 0; i < size * size; ++i)
      EXPECT_NEAR(picture.texels[4 * i], 188, 2) << size;
  }
}

TEST(TexturedRasterTest, NoSeamIsSeenBetweenFacetsOfOneTexture) {
  images::Image ramp(64, 64, 3);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x)
      ramp.at(x, y)[0] = screen_value((x + y) / 126.0);
  }
  const images::Image picture = drawn_square(40, 2, MipTexture(ramp));
  for (std::uint32_t y = 2; y < 38; ++y) {
    for (std::uint32_t x = 2; x < 38; ++x) {
      EXPECT_NEAR(light_of(picture.at(x, y)[0] / 255.0), (x + y + 1) / 80.0, 0.02);
      ASSERT_EQ(picture.at(x, y)[3], 255);
    }
  }
}

/// Red; the left half has one alpha, the right half another.
images::Image two_alphas(std::uint8_t left, std::uint8_t right) {
  images::Image image(64, 64, 4);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      image.at(x, y)[0] = 255;
      image.at(x, y)[3] = x < 32 ? left : right;
    }
  }
  return image;
}

TEST(TexturedRasterTest, WhereAPictureIsTransparentThereIsWhatIsBehind) {
  for (const AlphaMode alpha : {AlphaMode::mask, AlphaMode::blend}) {
    const images::Image picture = drawn_square(64, 2, MipTexture(two_alphas(255, 0), {}, alpha));
    EXPECT_EQ(picture.at(8, 32)[3], 255);
    EXPECT_EQ(picture.at(8, 32)[0], 255);
    EXPECT_EQ(picture.at(56, 32)[3], 0);
  }
  const images::Image opaque = drawn_square(64, 2, MipTexture(two_alphas(255, 0)));
  EXPECT_EQ(opaque.at(56, 32)[3], 255);
}

TEST(TexturedRasterTest, HalfOfAPixelIsSeenOfWhatIsHalfTransparent) {
  const images::Image halves = two_alphas(64, 128);
  const images::Image blended = drawn_square(64, 2, MipTexture(halves, {}, AlphaMode::blend));
  EXPECT_NEAR(blended.at(8, 32)[3], 64, 1);
  EXPECT_NEAR(blended.at(56, 32)[3], 128, 1);
  const images::Image masked = drawn_square(64, 2, MipTexture(halves, {}, AlphaMode::mask));
  EXPECT_EQ(masked.at(8, 32)[3], 0);
  EXPECT_EQ(masked.at(56, 32)[3], 255);
  // From afar, too.
  const images::Image small = drawn_square(4, 2, MipTexture(halves, {}, AlphaMode::blend));
  EXPECT_NEAR(small.at(0, 2)[3], 64, 1);
}

TEST(TexturedRasterTest, ColoursMultiplyTheLightOfATintedSkin) {
  images::Image grey(1, 1, 3);
  grey.texels = {128, 128, 128};
  const MipTexture texture(std::move(grey));
  Facet facet = flat_facet({-9, -9, -1}, {9, -9, -1}, {0, 20, -1});
  for (FacetCorner& corner : facet)
    corner.colour = {0.5F, 1, 0};
  const auto drawn = [&](bool is_tinted) {
    Raster raster(square_camera(4));
    raster.draw(facet, {&texture, {}, is_tinted});
    const images::Image image = shade(raster, {.kind = Light::none});
    return std::array{image.at(1, 1)[0], image.at(1, 1)[1], image.at(1, 1)[2]};
  };
  EXPECT_EQ(drawn(false), (std::array<std::uint8_t, 3>{128, 128, 128}));
  const auto half = screen_value(static_cast<float>(light_of(128.0 / 255) / 2));
  EXPECT_EQ(drawn(true), (std::array<std::uint8_t, 3>{half, 128, 0}));
}

TEST(TexturedRasterTest, OfTwoFacetsTheNearestIsSeenWithItsSkin) {
  const MipTexture white(checker(8, 8));
  Raster raster(square_camera(4));
  raster.draw(flat_facet({-9, -9, -1}, {9, -9, -1}, {0, 20, -1}), {&white, {}});
  raster.draw(flat_facet({-9, -9, -2}, {9, -9, -2}, {0, 20, -2}));
  EXPECT_EQ(shade(raster, {.kind = Light::none}).at(1, 1)[0], 255);
  raster.draw(flat_facet({-9, -9, 0}, {9, -9, 0}, {0, 20, 0}));
  EXPECT_EQ(shade(raster, {.kind = Light::none}).at(1, 1)[0], screen_value(kPlainColour.x));
}

}  // namespace
}  // namespace meshhier::render
