#include "images/pyramid.h"

#include "base/srgb.h"
#include "tests/images/samples.h"

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using Texels = std::vector<std::uint8_t>;

Texels halved(const Texels& above, const Texels& below, std::uint32_t channels) {
  const auto width = static_cast<std::uint32_t>(above.size() / channels);
  Texels means(std::size_t{(width + 1) / 2} * channels);
  halve_rows(above.data(), below.data(), width, channels, means.data());
  return means;
}

TEST(PyramidTest, SidesAreHalvedAndRoundedUp) {
  const TexelSize picture{100, 7};
  ASSERT_EQ(level_count(picture), 8U);
  const std::array<TexelSize, 8> sizes{
      {{100, 7}, {50, 4}, {25, 2}, {13, 1}, {7, 1}, {4, 1}, {2, 1}, {1, 1}}};
  for (std::uint32_t level = 0; level < 8; ++level)
    EXPECT_EQ(level_size(picture, level), sizes[level]) << level;
  EXPECT_EQ(level_count({1, 1}), 1U);
  EXPECT_EQ(level_count({65535, 1}), 17U);
  EXPECT_EQ(level_size({65535, 65535}, 16), (TexelSize{1, 1}));
}

TEST(PyramidTest, ConstantAreasStayAsTheyAre) {
  for (int value = 0; value < 256; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    const auto other = static_cast<std::uint8_t>(255 - value);
    for (const int alpha : {0, 1, 2, 100, 254, 255}) {
      const Texels texel{byte, other, 7, static_cast<std::uint8_t>(alpha)};
      Texels row = texel;
      row.insert(row.end(), texel.begin(), texel.end());
      ASSERT_EQ(halved(row, row, 4), texel);
    }
    ASSERT_EQ(halved({byte, other, 9, byte, other, 9}, {byte, other, 9, byte, other, 9}, 3),
              (Texels{byte, other, 9}));
  }
}

/// Half white, half black is half of the light: 188, not 128.
TEST(PyramidTest, MeansAreOfLight) {
  EXPECT_EQ(halved({255, 255, 255, 0, 0, 0}, {0, 0, 0, 255, 255, 255}, 3), (Texels{188, 188, 188}));
}

TEST(PyramidTest, MeansAreNearToThoseOfExactLight) {
  const Image image = noise(64, 2);
  Texels means(32 * 3);
  halve_rows(image.at(0, 0), image.at(0, 1), 64, 3, means.data());
  for (std::uint32_t x = 0; x < 32; ++x) {
    for (int c = 0; c < 3; ++c) {
      double light = 0;
      for (const std::uint8_t* texel :
           {image.at(2 * x, 0), image.at(2 * x + 1, 0), image.at(2 * x, 1), image.at(2 * x + 1, 1)})
        light += light_of(texel[c] / 255.0) / 4;
      ASSERT_NEAR(means[3 * x + c], screen_value(light), 1);
    }
  }
}

TEST(PyramidTest, TransparentTexelsHaveNoSay) {
  EXPECT_EQ(halved({200, 10, 30, 255, 1, 2, 3, 0}, {200, 10, 30, 255, 9, 9, 9, 0}, 4),
            (Texels{200, 10, 30, 128}));
  EXPECT_EQ(halved({200, 10, 30, 0}, {200, 10, 30, 0}, 4), (Texels{200, 10, 30, 0}));
}

TEST(PyramidTest, AnOddColumnStandsAlone) {
  EXPECT_EQ(halved({1, 1, 1, 1, 1, 1, 99, 98, 97}, {1, 1, 1, 1, 1, 1, 99, 98, 97}, 3),
            (Texels{1, 1, 1, 99, 98, 97}));
}

}  // namespace
}  // namespace meshhier::images
