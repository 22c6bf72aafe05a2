#include "images/fitted.h"

#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

/// A function of libwebp: it tells which instructions a processor has, by their numbers.
extern "C" int (*VP8GetCPUInfo)(int feature);

namespace meshhier::images {
namespace {

TEST(FittedTest, APictureThatFitsKeepsItsSidesAndItsQuality) {
  const Image image = waves(160, 120, 4);
  const FittedImage fitted = encode_to_fit(image, 40000);
  EXPECT_EQ(fitted.width, 160U);
  EXPECT_EQ(fitted.height, 120U);
  EXPECT_EQ(fitted.file, encode_image(image, ImageFormat::webp, 90));
}

TEST(FittedTest, WhatIsTooLargeLosesQualityThenSize) {
  const Image image = waves(160, 120, 4);
  const std::size_t best = encode_image(image, ImageFormat::webp, 90).size();
  const FittedImage coarser = encode_to_fit(image, best - 1);
  EXPECT_EQ(coarser.width, 160U);
  EXPECT_LT(coarser.file.size(), best);
  const FittedImage smaller = encode_to_fit(noise(512, 512, 4), 40000);
  EXPECT_LT(smaller.width, 512U);
  EXPECT_LE(smaller.file.size(), 40000U);
  const Image read = decoded(smaller.file);
  EXPECT_EQ(read.width, smaller.width);
  EXPECT_EQ(read.height, smaller.height);
}

TEST(FittedTest, OddSidesAreHalvedToo) {
  Image image(3, 1, 4);
  image.texels = {200, 0, 0, 255, 0, 200, 0, 255, 0, 0, 100, 255};
  const FittedImage fitted = encode_to_fit(image, 1);
  EXPECT_EQ(fitted.width, 1U);
  EXPECT_EQ(fitted.height, 1U);
  EXPECT_FALSE(fitted.file.empty());
}

/// The library has other code for each kind of processor.
TEST(FittedTest, TheBytesAreTheSameWithWhateverInstructions) {
  int (*const real)(int) = VP8GetCPUInfo;
  for (const Image& image : {waves(160, 120, 4), noise(64, 64, 4)}) {
    VP8GetCPUInfo = real;
    const FittedImage with = encode_to_fit(image, 2500);
    VP8GetCPUInfo = [](int) { return 0; };
    const FittedImage without = encode_to_fit(image, 2500);
    VP8GetCPUInfo = real;
    EXPECT_EQ(with.file, without.file);
  }
}

}  // namespace
}  // namespace meshhier::images
