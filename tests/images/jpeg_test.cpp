#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

ImageInfo info_of(const Bytes& bytes) {
  return open_image(source_of(bytes), "sample")->info();
}

TEST(JpegTest, ColoursOfAllKindsBecomeRgb) {
  const Image image = waves(150, 77);
  for (const JpegKind kind : {JpegKind{}, JpegKind{.separate = true}, JpegKind{.arithmetic = true},
                              JpegKind{.progressive = true}, JpegKind{.restart = 1},
                              JpegKind{.progressive = true, .arithmetic = true}}) {
    const Bytes file = jpeg_file(image, kind);
    EXPECT_LE(difference(decoded(file), image), 4)
        << kind.separate << kind.arithmetic << kind.progressive << kind.restart;
    EXPECT_EQ(info_of(file).channels, 3U);
    EXPECT_EQ(info_of(file).format, ImageFormat::jpeg);
  }
}

TEST(JpegTest, GreyBecomesRgb) {
  const Image image = waves(40, 33);
  const Image grey = decoded(jpeg_file(image, {.components = 1}));
  ASSERT_EQ(grey.channels, 3U);
  for (std::uint32_t y = 0; y < 33; ++y) {
    for (std::uint32_t x = 0; x < 40; ++x) {
      ASSERT_NEAR(grey.at(x, y)[0], image.at(x, y)[0], 4);
      ASSERT_EQ(grey.at(x, y)[0], grey.at(x, y)[1]);
      ASSERT_EQ(grey.at(x, y)[0], grey.at(x, y)[2]);
    }
  }
}

TEST(JpegTest, InkBecomesLightWithAdobesMarkAndWithout) {
  const Image image = waves(64, 40);
  for (const bool adobe : {false, true}) {
    const Image direct =
        decoded(jpeg_file(image, {.components = 4, .separate = true, .adobe = adobe}));
    EXPECT_LE(difference(direct, image), 4) << adobe;
  }
  // Without the mark nothing says that four components are YCCK.
  const Image turned = decoded(jpeg_file(image, {.components = 4, .adobe = true}));
  EXPECT_LE(difference(turned, image), 8);
}

TEST(JpegTest, CoarseChromaIsSmoothed) {
  const Image image = waves(200, 100);
  const Image coarse = decoded(jpeg_file(image, {.factor = 2}));
  EXPECT_LE(difference(coarse, image), 60);
  EXPECT_EQ(coarse, decoded(jpeg_file(image, {.factor = 2, .progressive = true})));
}

TEST(JpegTest, ProgressiveHoldsAllCoefficients) {
  const Image image = waves(100, 50);
  const std::uint64_t rows = info_of(jpeg_file(image, {.factor = 2})).decoder_bytes;
  EXPECT_LE(rows, 100 * 3 * 64);
  // 100 x 50 in blocks of 8, luma in pairs: 14 x 8; chroma 7 x 4.
  EXPECT_EQ(info_of(jpeg_file(image, {.factor = 2, .progressive = true})).decoder_bytes,
            rows + (14 * 8 + 2 * 7 * 4) * 64 * 2);
}

TEST(JpegTest, WhatStandsBehindThePictureIsIgnored) {
  Bytes file = jpeg_file(waves(30, 20), {});
  const Image image = decoded(file);
  file.resize(file.size() + 1000);
  EXPECT_EQ(decoded(file), image);
}

/// Programs leave such bytes; the picture is whole.
TEST(JpegTest, ExtraBytesBeforeTheEndAreIgnored) {
  Bytes file = jpeg_file(waves(30, 20), {});
  const Image image = decoded(file);
  file.insert(file.end() - 2, 3, std::byte{0});
  EXPECT_EQ(decoded(file), image);
}

}  // namespace
}  // namespace meshhier::images
