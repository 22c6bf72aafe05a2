#include "images/direction_codes.h"

#include "images/image.h"
#include "images/image_codec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

/// Decodes what was written of a map.
Image back(const Image& map, int quality) {
  return decode_image(encode_normal_map(map, {.format = ImageFormat::jpeg, .quality = quality}),
                      "a map", std::uint64_t{map.width} * map.height);
}

template <std::size_t kSymbols>
void expect_codes_all(const JpegCode<kSymbols>& code) {
  EXPECT_EQ(std::set(code.symbols.begin(), code.symbols.end()).size(), kSymbols);
  std::size_t count = 0;
  std::uint32_t taken = 0;  // of the 2^16 words of 16 bits
  for (std::size_t bits = 1; bits <= 16; ++bits) {
    count += code.counts[bits - 1];
    taken += std::uint32_t{code.counts[bits - 1]} << (16 - bits);
  }
  EXPECT_EQ(count, kSymbols);
  EXPECT_LT(taken, 65536U) << "the word of ones alone is no code";
}

TEST(DirectionCodes, CodeAllSymbols) {
  for (const JpegCodePair& codes : kDirectionCodes) {
    expect_codes_all(codes.steady);
    expect_codes_all(codes.changes);
    for (const std::uint8_t symbol : codes.steady.symbols)
      EXPECT_LE(symbol, 11);
    for (const std::uint8_t symbol : codes.changes.symbols)
      EXPECT_TRUE(symbol == 0 || symbol == 0xf0 || (symbol % 16 >= 1 && symbol % 16 <= 10));
  }
}

// Noise and checkers have coefficients of all sizes.
TEST(DirectionCodes, KeepWhateverAMapShows) {
  std::mt19937 random(5);
  for (const std::uint32_t size : {1U, 2U, 8U, 64U}) {
    Image map(100, 60, 3);
    for (std::uint32_t y = 0; y < map.height; ++y) {
      for (std::uint32_t x = 0; x < map.width; ++x) {
        const bool is_noise = x > 50;
        for (std::uint32_t c = 0; c < 3; ++c)
          map.at(x, y)[c] = static_cast<std::uint8_t>(
              is_noise ? random() % 256 : ((x / size + y / size) % 2 == 0 ? 0 : 255));
      }
    }
    for (const int quality : {1, 74, 75, 85, 95, 96, 100}) {
      const Image shown = back(map, quality);
      ASSERT_EQ(shown.width, map.width);
      ASSERT_EQ(shown.height, map.height);
      if (quality < 90)
        continue;
      double sum = 0;  // of red's and green's differences
      for (std::size_t i = 0; i < map.texels.size(); i += 3)
        sum += std::abs(map.texels[i] - shown.texels[i]) +
               std::abs(map.texels[i + 1] - shown.texels[i + 1]);
      EXPECT_LT(sum / (2.0 * map.width * map.height), 6);
    }
  }
}

TEST(DirectionCodes, AFlatMapIsSmall) {
  Image map(512, 512, 3);
  for (std::size_t i = 0; i < map.texels.size(); i += 3)
    std::ranges::copy(std::array<std::uint8_t, 3>{128, 128, 255}, map.texels.begin() + i);
  EXPECT_EQ(back(map, 85), map);
  EXPECT_LT(encode_normal_map(map, {.format = ImageFormat::jpeg, .quality = 85}).size(), 6000U);
}

}  // namespace
}  // namespace meshhier::images
