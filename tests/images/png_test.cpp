#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

constexpr std::uint32_t kWidth = 37, kHeight = 21;

/// Numbers of a few bits, packed as PNG has them; two bytes of 16.
std::vector<std::uint8_t> packed(const std::vector<std::uint32_t>& values, std::size_t row_values,
                                 int depth) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < values.size(); i += row_values) {
    std::uint32_t bits = 0;
    int count = 0;
    for (std::size_t k = i; k < i + row_values; ++k) {
      bits = bits << depth | values[k];
      for (count += depth; count >= 8; count -= 8)
        bytes.push_back(static_cast<std::uint8_t>(bits >> (count - 8)));
    }
    if (count > 0)
      bytes.push_back(static_cast<std::uint8_t>(bits << (8 - count)));
  }
  return bytes;
}

std::vector<std::uint32_t> numbers(std::size_t count, int depth) {
  std::vector<std::uint32_t> values;
  const Image random = noise(static_cast<std::uint32_t>(count), 2, 1);
  for (std::size_t i = 0; i < count; ++i)
    values.push_back((random.texels[i] << 8U | random.texels[count + i]) >> (16 - depth));
  return values;
}

/// The nearest of 8 bits.
std::uint8_t as_byte(std::uint32_t value, int depth) {
  const std::uint32_t most = (1U << depth) - 1;
  return static_cast<std::uint8_t>((2 * 255 * value + most) / (2 * most));
}

class PngKindTest : public testing::TestWithParam<bool> {};

TEST_P(PngKindTest, GreyOfAnyDepth) {
  for (const int depth : {1, 2, 4, 8, 16}) {
    const auto values = numbers(kWidth * kHeight, depth);
    const Image image =
        decoded(png_file(kWidth, kHeight, {.colour = 0, .depth = depth, .interlaced = GetParam()},
                         packed(values, kWidth, depth)));
    ASSERT_EQ(image.channels, 3U);
    for (std::size_t i = 0; i < values.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_EQ(image.texels[3 * i + c], as_byte(values[i], depth)) << depth << " " << i;
    }
  }
}

TEST_P(PngKindTest, GreyAndAlpha) {
  for (const int depth : {8, 16}) {
    const auto values = numbers(std::size_t{2} * kWidth * kHeight, depth);
    const Image image =
        decoded(png_file(kWidth, kHeight, {.colour = 4, .depth = depth, .interlaced = GetParam()},
                         packed(values, 2 * kWidth, depth)));
    ASSERT_EQ(image.channels, 4U);
    for (std::size_t i = 0; i < values.size(); ++i)
      ASSERT_EQ(image.texels[i / 2 * 4 + (i % 2 == 0 ? 1 : 3)], as_byte(values[i], depth));
  }
}

TEST_P(PngKindTest, ColoursWithAlphaAndWithout) {
  for (const int depth : {8, 16}) {
    for (const std::uint32_t channels : {3U, 4U}) {
      const auto values = numbers(std::size_t{channels} * kWidth * kHeight, depth);
      const Image image = decoded(
          png_file(kWidth, kHeight,
                   {.colour = channels == 3 ? 2 : 6, .depth = depth, .interlaced = GetParam()},
                   packed(values, channels * kWidth, depth)));
      ASSERT_EQ(image.channels, channels);
      for (std::size_t i = 0; i < values.size(); ++i)
        ASSERT_EQ(image.texels[i], as_byte(values[i], depth));
    }
  }
}

TEST_P(PngKindTest, PalettesWithAlphaAndWithout) {
  for (const int depth : {1, 2, 4, 8}) {
    const auto values = numbers(kWidth * kHeight, depth);
    const std::vector<std::uint8_t> palette = noise(1U << depth, 1).texels;
    for (const bool clear : {false, true}) {
      const std::vector<std::uint8_t> alpha =
          clear ? std::vector<std::uint8_t>{7, 99} : std::vector<std::uint8_t>{};
      const Image image = decoded(png_file(kWidth, kHeight, {3, depth, GetParam(), palette, alpha},
                                           packed(values, kWidth, depth)));
      ASSERT_EQ(image.channels, clear ? 4U : 3U);
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::uint8_t* texel = image.texels.data() + i * image.channels;
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_EQ(texel[c], palette[3 * values[i] + c]);
        if (clear) {
          ASSERT_EQ(texel[3], values[i] < 2 ? alpha[values[i]] : 255);
        }
      }
    }
  }
}

/// All of 16 bits count: 0x0102 is not 0x0103.
TEST_P(PngKindTest, OneColourMayBeTransparent) {
  const std::vector<std::uint8_t> row{1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 3};
  const Image image = decoded(png_file(2, 1, {2, 16, GetParam(), {}, {1, 2, 1, 2, 1, 2}}, row));
  ASSERT_EQ(image.channels, 4U);
  EXPECT_EQ(image.texels[3], 0);
  EXPECT_EQ(image.texels[7], 255);
  const Image grey = decoded(png_file(2, 1, {0, 8, GetParam(), {}, {0, 9}}, {9, 10}));
  EXPECT_EQ(grey.texels, (std::vector<std::uint8_t>{9, 9, 9, 0, 10, 10, 10, 255}));
}

INSTANTIATE_TEST_SUITE_P(, PngKindTest, testing::Bool(), [](const auto& test) {
  return std::string(test.param ? "Interlaced" : "RowByRow");
});

TEST(PngTest, InterlacedHoldsThePicture) {
  const auto bytes_of = [](bool interlaced) {
    const Bytes file = png_file(300, 200, {.interlaced = interlaced}, noise(300, 200).texels);
    return open_image(source_of(file), "sample")->info().decoder_bytes;
  };
  EXPECT_LT(bytes_of(false), 100'000U);
  EXPECT_EQ(bytes_of(true), bytes_of(false) + 300 * 200 * 3);
}

/// A row has an index of 3, the palette has two colours.
TEST(PngTest, AnIndexBeyondThePaletteIsBlack) {
  const Image image =
      decoded(png_file(4, 1, {.colour = 3, .depth = 2, .palette = {1, 2, 3, 4, 5, 6}}, {0x1b}));
  EXPECT_EQ(image.texels, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace meshhier::images
