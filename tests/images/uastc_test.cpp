// Blocks of UASTC: packed, unpacked, made of texels.
#include "images/image_codec.h"
#include "images/pyramid.h"
#include "images/uastc_block.h"
#include "images/uastc_encoder.h"
#include "images/uastc_picture.h"
#include "storage/io/hash.h"
#include "tests/images/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using testing::HasSubstr;

using FourByFour = std::array<Rgba, kBlockTexels>;

FourByFour texels_by(const std::function<Rgba(std::uint32_t x, std::uint32_t y)>& texel) {
  FourByFour texels;
  for (std::uint32_t i = 0; i < kBlockTexels; ++i)
    texels[i] = texel(i % 4, i / 4);
  return texels;
}

/// Returns the root mean square over all channels.
double off(const FourByFour& a, const FourByFour& b) {
  double sum = 0;
  for (std::size_t i = 0; i < kBlockTexels; ++i) {
    for (std::size_t c = 0; c < 4; ++c)
      sum += std::pow(double{1} * a[i][c] - b[i][c], 2);
  }
  return std::sqrt(sum / (4 * kBlockTexels));
}

double coding_error(const FourByFour& texels) {
  const UastcBytes bytes = pack_block(UastcEncoder(kColourEffort).encode(texels));
  return off(texels, texels_of(*unpack_block(bytes)));
}

UastcBlock random_block(std::uint8_t number, std::mt19937& random) {
  const UastcMode& mode = uastc_mode(number);
  const auto below = [&](std::uint32_t count) {
    return static_cast<std::uint8_t>(random() % count);
  };
  UastcBlock block;
  block.mode = number;
  block.hints.difference = below(2) != 0;
  block.hints.intensities[0] = below(8);
  if (number == kSolidMode) {
    for (std::uint8_t& channel : block.solid)
      channel = below(256);
    block.hints.selector = below(4);
    for (std::uint8_t& channel : block.hints.colour)
      channel = below(32);
    return block;
  }
  block.hints.bc1_endpoints = below(2) != 0;
  block.hints.flip = below(2) != 0;
  block.hints.intensities[1] = below(8);
  if (mode.has_second_bc1_hint)
    block.hints.bc1_weights = below(2) != 0;
  if (mode.has_etc1_bias)
    block.hints.bias = below(32);
  if (mode.has_alpha())
    block.hints.alpha = below(256);
  if (mode.patterns != Patterns::none)
    block.pattern = below(static_cast<std::uint32_t>(patterns_of(mode.patterns).size()));
  block.plane_channel = mode.planes == 2 && mode.channels > 2 ? below(mode.channels) : 3;
  for (std::size_t i = 0; i < mode.endpoints(); ++i)
    block.endpoints[i] = below(mode.range.levels());
  for (std::size_t i = 0; i < mode.weights(); ++i)
    block.weights[i] = below(1U << mode.weight_bits);
  return block;
}

TEST(UastcBlockTest, WhatIsPackedIsUnpacked) {
  std::mt19937 random(1);
  for (std::uint8_t mode = 0; mode < kUastcModes; ++mode) {
    for (int i = 0; i < 300; ++i) {
      UastcBlock block = random_block(mode, random);
      const FourByFour before = texels_of(block);
      orient(block);
      EXPECT_EQ(texels_of(block), before) << "mode " << int{mode};
      const UastcBytes bytes = pack_block(block);
      const auto unpacked = unpack_block(bytes);
      ASSERT_TRUE(unpacked);
      EXPECT_EQ(texels_of(*unpacked), before) << "mode " << int{mode};
      EXPECT_EQ(pack_block(*unpacked), bytes) << "mode " << int{mode};
    }
  }
}

TEST(UastcBlockTest, WhatIsNoBlockIsRefused) {
  UastcBytes bytes{};
  bytes[0] = std::byte{0x45};  // kept for modes to come
  EXPECT_FALSE(unpack_block(bytes));
  for (const auto& [mode, most] : {std::pair(2, 30), std::pair(3, 11), std::pair(7, 19)}) {
    UastcBlock block;
    block.mode = static_cast<std::uint8_t>(mode);
    for (std::uint32_t pattern = 0; pattern < (mode == 3 ? 16U : 32U); ++pattern) {
      bytes = pack_block(block);
      const std::uint32_t at = uastc_mode(block.mode).code_bits + 15U;
      for (std::uint32_t bit = 0; bit < 5; ++bit)
        bytes[(at + bit) / 8] |=
            std::byte{static_cast<std::uint8_t>((pattern >> bit & 1) << ((at + bit) % 8))};
      EXPECT_EQ(unpack_block(bytes).has_value(), static_cast<int>(pattern) < most) << mode;
    }
  }
}

TEST(UastcBlockTest, PatternsAreDifferentOnesOfAsFewSubsets) {
  for (const auto& [list, count, subsets] : {std::tuple(Patterns::two, 30U, 2U),
                                             {Patterns::three, 11U, 3U},
                                             {Patterns::two_of_three, 19U, 2U}}) {
    const auto patterns = patterns_of(list);
    EXPECT_EQ(patterns.size(), count);
    EXPECT_EQ(std::set(patterns.begin(), patterns.end()).size(), count);
    for (const Pattern& pattern : patterns)
      EXPECT_EQ(std::set(pattern.begin(), pattern.end()).size(), subsets);
  }
  // The left half and the right one, as BC7 has them first.
  EXPECT_EQ(patterns_of(Patterns::two)[0],
            (Pattern{0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1}));
}

TEST(UastcBlockTest, EndpointsReachFromBlackToWhite) {
  for (std::uint8_t mode = 0; mode < kUastcModes; ++mode) {
    const EndpointRange range = uastc_mode(mode).range;
    const EndpointTable& table = endpoint_table(range);
    const std::set<std::uint8_t> values(
        table.values.begin(), table.values.begin() + static_cast<std::ptrdiff_t>(range.levels()));
    EXPECT_EQ(values.size(), range.levels());
    EXPECT_EQ(*values.begin(), 0);
    EXPECT_EQ(*values.rbegin(), 255);
    const int step = 255 / static_cast<int>(range.levels() - 1) + 2;
    for (int value = 0; value < 256; ++value)
      EXPECT_LE(2 * std::abs(table.values[table.nearest[static_cast<std::size_t>(value)]] - value),
                step)
          << range.levels();
  }
}

TEST(UastcEncoderTest, OneColourIsExact) {
  for (const Rgba colour : {Rgba{0, 0, 0, 255}, Rgba{1, 2, 3, 4}, Rgba{255, 255, 255, 255}})
    EXPECT_EQ(coding_error(texels_by([&](auto, auto) { return colour; })), 0);
}

TEST(UastcEncoderTest, KindsOfBlocksComeBackNearly) {
  const auto byte = [](double value) { return static_cast<std::uint8_t>(value); };
  // A slope of one colour, with and without alpha.
  EXPECT_LE(coding_error(texels_by([&](auto x, auto y) {
              return Rgba{byte(10 + 9 * x), byte(20 + 9 * y), 30, 255};
            })),
            6);
  EXPECT_LE(coding_error(texels_by([&](auto x, auto) {
              return Rgba{byte(80 * x), byte(40 * x), 90, 255};
            })),
            1.5);
  EXPECT_LE(coding_error(texels_by([&](auto x, auto) {
              return Rgba{byte(80 * x), byte(40 * x), 90, byte(60 * x)};
            })),
            3);
  // Two colours that have nothing in common: two lines.
  EXPECT_LE(coding_error(texels_by([&](auto x, auto y) {
              return x < 2 ? Rgba{byte(200 + y * 5), 20, 30, 255}
                           : Rgba{10, byte(180 + y * 5), byte(200 - y * 9), 255};
            })),
            4);
  // A channel that goes its own way.
  EXPECT_LE(coding_error(texels_by([&](auto x, auto y) {
              return Rgba{byte(85 * x), byte(85 * x), byte(85 * y), 255};
            })),
            3);
  // A cut-out.
  EXPECT_LE(coding_error(texels_by([&](auto x, auto y) {
              return Rgba{byte(50 * x), 90, 100, byte(x > y ? 255 : 0)};
            })),
            4);
}

/// Returns four kinds of blocks: smooth ones and noise, opaque and not.
FourByFour mixed_block(const Image& image, std::uint32_t x, std::uint32_t y) {
  return texels_by([&](std::uint32_t dx, std::uint32_t dy) {
    const std::uint8_t* const t = image.at(x + dx, y + dy);
    const auto value = [&](std::size_t c) {
      return static_cast<std::uint8_t>(y < image.height / 2 ? 100 + t[c] / 16 + 7 * dx : t[c]);
    };
    return Rgba{value(0), value(1), value(2), x < image.width / 2 ? std::uint8_t{255} : value(3)};
  });
}

TEST(UastcEncoderTest, TheBytesAreTheSameOnEveryMachine) {
  const Image image = noise(64, 64, 4, 3);
  for (const auto& [effort, expected] : {std::pair(kColourEffort, 6129816669482231623ULL),
                                         {kDirectionEffort, 15857293218515995014ULL}}) {
    storage::Checksum checksum;
    UastcEncoder encoder(effort);
    for (std::uint32_t y = 0; y < 64; y += 4) {
      for (std::uint32_t x = 0; x < 64; x += 4)
        checksum.add(pack_block(encoder.encode(mixed_block(image, x, y))));
    }
    EXPECT_EQ(checksum.value(), expected);
  }
}

TEST(UastcEncoderTest, WeightsThatWereBeforeAreTakenAgain) {
  // The same ramp, brighter with each block, and a little noise.
  const Image grain = noise(400, 4);
  const auto sets = [&](float byte_error) {
    UastcEncoder encoder({80, 320, 2, false, byte_error});
    std::set<std::array<std::uint8_t, 32>> found;
    for (std::uint32_t i = 0; i < 100; ++i)
      found.insert(encoder
                       .encode(texels_by([&](std::uint32_t x, std::uint32_t y) {
                         const auto value = static_cast<std::uint8_t>(
                             i + 20 * x + 10 * y + grain.at(4 * i + x, y)[0] / 128);
                         return Rgba{value, value, value, 255};
                       }))
                       .weights);
    return found.size();
  };
  EXPECT_LT(3 * sets(8), 2 * sets(0));
}

TEST(UastcPictureTest, LevelsAreHalvesDownToATexel) {
  const Image image = waves(44, 12);
  const Bytes file = encode_uastc(image, Ktx2Meaning::colours);
  EXPECT_EQ(file, encode_uastc(image, Ktx2Meaning::colours));
  EXPECT_NE(file, encode_uastc(image, Ktx2Meaning::directions));
  EXPECT_LE(difference(decoded(file), image), 40);
}

}  // namespace
}  // namespace meshhier::images
