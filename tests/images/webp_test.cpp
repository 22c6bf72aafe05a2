#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using testing::HasSubstr;

TEST(WebpTest, LosslessPicturesComeBack) {
  for (const std::uint32_t channels : {3U, 4U}) {
    const Image image = waves(97, 61, channels);
    const Bytes file = webp_file(image, 100);
    EXPECT_EQ(decoded(file), image);
    const ImageInfo info = open_image(source_of(file), "sample")->info();
    EXPECT_EQ(info.format, ImageFormat::webp);
    EXPECT_GE(info.decoder_bytes, file.size() + image.texels.size() + 4 * 97 * 61);
  }
}

TEST(WebpTest, LossyPicturesAreNear) {
  for (const std::uint32_t channels : {3U, 4U}) {
    Image image = waves(97, 61, channels);
    const Image read = decoded(webp_file(image, 95));
    ASSERT_EQ(read.channels, channels);
    EXPECT_LE(difference(read, image), 80);
    if (channels == 3)
      continue;
    for (std::size_t i = 3; i < image.texels.size(); i += 4)
      ASSERT_EQ(read.texels[i], image.texels[i]);
  }
}

/// An extended file (VP8X) whose flags say that it is animated.
TEST(WebpTest, AnimatedOnesAreRefused) {
  const std::string head = std::string("RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\x02\0\0\0", 24) +
                           std::string("\x0f\0\0\x0f\0\0", 6);
  const auto* first = reinterpret_cast<const std::byte*>(head.data());
  const Bytes file(first, first + head.size());
  EXPECT_THAT(refusal([&] { open_image(source_of(file), "walk.webp"); }),
              HasSubstr("walk.webp: the picture is animated"));
}

}  // namespace
}  // namespace meshhier::images
