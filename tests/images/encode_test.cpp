// Tests of encode_image().
#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

TEST(EncodeTest, PngIsExact) {
  for (const std::uint32_t channels : {3U, 4U}) {
    for (const Image& image : {waves(1, 1, channels), waves(131, 67, channels),
                               noise(64, 64, channels), noise(1, 300, channels)}) {
      EXPECT_EQ(decoded(encode_image(image, ImageFormat::png, 90)), image);
    }
  }
}

TEST(EncodeTest, WebpIsExactAt100) {
  for (const std::uint32_t channels : {3U, 4U}) {
    for (const Image& image :
         {waves(1, 1, channels), waves(131, 67, channels), noise(64, 64, channels)})
      EXPECT_EQ(decoded(encode_image(image, ImageFormat::webp, 100)), image);
  }
}

TEST(EncodeTest, WebpKeepsColoursUnderTransparentTexels) {
  Image image = waves(64, 64, 4);
  for (std::size_t i = 3; i < image.texels.size(); i += 4)
    image.texels[i] = 0;
  EXPECT_EQ(decoded(encode_image(image, ImageFormat::webp, 100)), image);
  EXPECT_LE(difference(decoded(encode_image(image, ImageFormat::webp, 90)), image), 80);
}

TEST(EncodeTest, MoreQualityIsNearerAndLarger) {
  const Image image = waves(256, 128);
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::webp}) {
    const Bytes rough = encode_image(image, format, 40), fine = encode_image(image, format, 95);
    EXPECT_LT(rough.size(), fine.size());
    EXPECT_GT(difference(decoded(rough), image), difference(decoded(fine), image));
  }
}

/// Red and blue columns side by side: half of chroma's samples would mix them.
TEST(EncodeTest, JpegHasAllOfTheChromaFrom90On) {
  Image image(64, 64, 3);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x)
      image.at(x, y)[x % 2 == 0 ? 0 : 2] = 255;
  }
  EXPECT_LE(difference(decoded(encode_image(image, ImageFormat::jpeg, 90)), image), 60);
  EXPECT_GE(difference(decoded(encode_image(image, ImageFormat::jpeg, 89)), image), 100);
}

TEST(EncodeTest, EqualPicturesAreEqualBytes) {
  const Image image = waves(200, 150);
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp})
    EXPECT_EQ(encode_image(image, format, 85), encode_image(image, format, 85));
}

}  // namespace
}  // namespace meshhier::images
