#include "images/formats.h"

#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

std::string_view text_of(const Bytes& file) {
  return {reinterpret_cast<const char*>(file.data()), file.size()};
}

/// All that this machine can code.
template <class Test>
void for_each_format(const Test& test) {
  for (const ImageFormatRow& row : kImageFormats) {
    SCOPED_TRACE(row.name);
    if (missing_coder({row.value, 1, true}).empty())
      test(row);
  }
  end_coders();
}

TEST(FormatsTest, AFileIsKnownByItsOwnMarksAlone) {
  for_each_format([](const ImageFormatRow& written) {
    const Bytes file = encode_image(waves(16, 12), written.value, 90);
    for (const ImageFormatRow& row : kImageFormats)
      EXPECT_EQ(row.file.is_start(text_of(file)), row.value == written.value) << row.name;
    EXPECT_FALSE(written.file.is_start(text_of(file).substr(0, 2)));
  });
}

TEST(FormatsTest, WhatIsWrittenIsReadAgain) {
  for_each_format([](const ImageFormatRow& row) {
    for (const std::uint32_t channels : {3U, 4U}) {
      if (channels == 4 && !row.has_alpha)
        continue;
      const Image image = waves(16, 12, channels);
      for (const int quality : {1, 50, kBestQuality}) {
        const Bytes file = encode_image(image, row.value, quality);
        const ImageInfo info = open_image(source_of(file), "sample")->info();
        EXPECT_EQ(info.format, row.value);
        EXPECT_EQ(info.width, 16U);
        EXPECT_EQ(info.height, 12U);
        EXPECT_EQ(info.channels, channels);
        EXPECT_TRUE(!is_exact(row.value, quality) || decoded(file) == image) << quality;
      }
    }
  });
}

TEST(FormatsTest, QualityDecidesAboutMapsWhereItIsSaid) {
  for_each_format([](const ImageFormatRow& row) {
    const Image map = waves(32, 32);
    const Bytes low = encode_normal_map(map, {row.value, 10}),
                high = encode_normal_map(map, {row.value, kBestQuality});
    EXPECT_EQ(low != high, row.graded_maps);
  });
}

TEST(FormatsTest, NamesAndEndingsAreThoseOfOneFormat) {
  for (const ImageFormatRow& one : kImageFormats) {
    EXPECT_EQ(one.file.media_type, "image/" + std::string(one.name));
    for (const ImageFormatRow& other : kImageFormats) {
      const std::string name = "a" + std::string(one.file.endings[0]);
      EXPECT_EQ(other.file.is_name(name), one.value == other.value) << name;
    }
    EXPECT_FALSE(one.file.is_name(one.file.endings[0]));
    EXPECT_EQ(one.in_browsers,
              std::ranges::find(kBrowserPictures, one.file.media_type, &PictureFile::media_type) !=
                  kBrowserPictures.end());
  }
}

TEST(FormatsTest, LibrariesMissNothing) {
  for (const ImageFormatRow& row : kImageFormats) {
    for (const int quality : {1, kBestQuality}) {
      if (coders_of(row.value).processes(quality) != nullptr)
        continue;
      EXPECT_EQ(missing_coder({row.value, quality, true}), "");
      EXPECT_EQ(coder_bytes({row.value, quality, true}, 1 << 20), 0U);
    }
  }
}

}  // namespace
}  // namespace meshhier::images
