// Pictures written row by row.
#include "images/row_writer.h"

#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

WrittenImage like(const Image& image, ImageFormat format) {
  return {format, 90, image.width, image.height, image.channels};
}

Bytes written(const Image& image, ImageFormat format,
              std::unique_ptr<RowWriter> (*open)(const WrittenImage&, ByteSink) = open_row_writer) {
  Bytes bytes;
  const auto writer = open(like(image, format), [&](std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  });
  for (std::uint32_t y = 0; y < image.height; ++y)
    writer->write_row(image.at(0, y));
  writer->finish();
  return bytes;
}

TEST(RowWriterTest, APngIsThatOfTheWholePicture) {
  for (const std::uint32_t channels : {3U, 4U}) {
    const Image image = waves(131, 67, channels);
    EXPECT_EQ(written(image, ImageFormat::png), encode_image(image, ImageFormat::png, 90));
  }
}

TEST(RowWriterTest, AJpegShowsTheSamePicture) {
  for (const Image& image : {waves(131, 67), noise(64, 300), waves(1, 1)}) {
    const Bytes bytes = written(image, ImageFormat::jpeg);
    const Bytes whole = encode_image(image, ImageFormat::jpeg, 90);
    EXPECT_EQ(decoded(bytes), decoded(whole));
    EXPECT_GE(bytes.size(), whole.size());
  }
}

TEST(RowWriterTest, ASmallPictureIsThatOfTheWhole) {
  const Image image = waves(131, 67);
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp}) {
    EXPECT_EQ(written(image, format, open_picture_writer), encode_image(image, format, 90));
    EXPECT_GT(held_bytes(like(image, format)), std::size_t{131 * 67});
  }
}

// However large a picture is, rows of it are held.
TEST(RowWriterTest, OfALargeJpegLittleIsHeld) {
  const Image image = waves(1025, 1024);
  EXPECT_EQ(written(image, ImageFormat::jpeg, open_picture_writer),
            written(image, ImageFormat::jpeg));
  EXPECT_EQ(held_bytes(like(image, ImageFormat::jpeg)),
            held_bytes({ImageFormat::jpeg, 90, 8192, 8192, 3}));
  EXPECT_LT(held_bytes({ImageFormat::jpeg, 90, 8192, 8192, 3}), std::uint64_t{2} << 20);
}

TEST(RowWriterTest, BytesComeWithTheRows) {
  const Image image = noise(1024, 256);
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png}) {
    std::size_t bytes = 0;
    const auto writer = open_row_writer(
        like(image, format), [&](std::span<const std::byte> more) { bytes += more.size(); });
    for (std::uint32_t y = 0; y < image.height / 2; ++y)
      writer->write_row(image.at(0, y));
    const std::size_t half = bytes;
    EXPECT_GT(half, std::size_t{100'000});
    for (std::uint32_t y = image.height / 2; y < image.height; ++y)
      writer->write_row(image.at(0, y));
    writer->finish();
    EXPECT_GT(bytes, 3 * half / 2);
  }
}

TEST(RowWriterTest, WhatTheSinkThrowsComesThrough) {
  const Image image = noise(1024, 256);
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png}) {
    const auto write = [&] {
      const auto writer = open_row_writer(like(image, format), [](std::span<const std::byte>) {
        throw std::runtime_error("the disk is full");
      });
      for (std::uint32_t y = 0; y < image.height; ++y)
        writer->write_row(image.at(0, y));
      writer->finish();
    };
    EXPECT_THROW(write(), std::runtime_error);
  }
}

}  // namespace
}  // namespace meshhier::images
