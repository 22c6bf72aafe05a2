// Pictures that are broken, end early or lie, and sources that fail.
#include "base/error.h"
#include "images/image_codec.h"
#include "tests/images/samples.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::uint64_t kMostTexels = 1 << 16;

std::string refused(const Bytes& bytes) {
  return refusal([&] { decode_image(bytes, "a.img", kMostTexels); });
}

Bytes bytes_of(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

void put_big(Bytes& bytes, std::size_t at, std::size_t count, std::uint32_t value) {
  for (std::size_t i = 0; i < count; ++i)
    bytes[at + i] = static_cast<std::byte>(value >> (8 * (count - 1 - i)));
}

/// The place of a JPEG's height and width: behind its frame's mark, length and depth.
std::size_t size_in_jpeg(const Bytes& bytes, std::byte frame) {
  const std::vector<std::byte> mark{std::byte{0xff}, frame};
  const auto found = std::search(bytes.begin(), bytes.end(), mark.begin(), mark.end());
  return static_cast<std::size_t>(found - bytes.begin()) + 5;
}

/// Returns the checksum of bytes, as PNG has it (CRC-32).
std::uint32_t crc(const Bytes& bytes, std::size_t from, std::size_t count) {
  std::uint32_t sum = ~0U;
  for (std::size_t i = from; i < from + count; ++i) {
    sum ^= static_cast<std::uint32_t>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit)
      sum = sum >> 1 ^ ((sum & 1) != 0 ? 0xedb88320U : 0);
  }
  return ~sum;
}

Bytes png_of_size(std::uint32_t width, std::uint32_t height) {
  Bytes bytes = png_file(2, 2, {.colour = 2}, std::vector<std::uint8_t>(12));
  put_big(bytes, 16, 4, width);
  put_big(bytes, 20, 4, height);
  put_big(bytes, 29, 4, crc(bytes, 12, 17));
  return bytes;
}

class HostileTest : public testing::TestWithParam<NamedFile> {};

TEST_P(HostileTest, CutAnywhereItIsRefused) {
  const Bytes& whole = GetParam().bytes;
  ASSERT_EQ(refused(whole), "");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_THAT(refused(cut), StartsWith("a.img")) << size;
  }
}

TEST_P(HostileTest, TheEndIsNamed) {
  const Bytes& whole = GetParam().bytes;
  const Bytes cut(whole.begin(), whole.end() - 1);
  EXPECT_THAT(refused(cut), StartsWith("a.img: the picture ends early")) << whole.size();
}

/// It is a picture of the promised shape, or it is refused.
TEST_P(HostileTest, AnyByteMayBeAnother) {
  Bytes bytes = GetParam().bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::byte right = bytes[i];
    for (const int wrong : {0x00, 0x01, 0x80, 0xff}) {
      bytes[i] = right ^ static_cast<std::byte>(wrong);
      const std::string message = refused(bytes);
      ASSERT_TRUE(message.empty() || message.starts_with("a.img")) << message;
    }
    bytes[i] = right;
  }
}

TEST_P(HostileTest, TheSourceMayGiveLittleAtATime) {
  const NamedFile& file = GetParam();
  for (const std::size_t most : {std::size_t{1}, std::size_t{7}}) {
    const auto reader = open_image(source_of(file.bytes, most), file.name);
    Image image(reader->info().width, reader->info().height, reader->info().channels);
    for (std::uint32_t y = 0; y < image.height; ++y)
      reader->read_rows(image.at(0, y), 1);
    EXPECT_EQ(image, decoded(file.bytes));
  }
}

TEST_P(HostileTest, WhatTheSourceThrowsComesThrough) {
  const NamedFile& file = GetParam();
  int calls = 0;
  const auto read_until = [&](int call) {
    calls = 0;
    const ByteSource source = source_of(file.bytes, 50);
    const auto reader = open_image(
        [&](std::uint64_t offset, std::span<std::byte> into) {
          if (calls++ == call)
            throw std::logic_error("the disk is gone");
          return source(offset, into);
        },
        file.name);
    Image image(reader->info().width, reader->info().height, reader->info().channels);
    reader->read_rows(image.texels.data(), image.height);
  };
  read_until(-1);
  for (int call = 0, all = calls; call < all; ++call)
    EXPECT_THROW(read_until(call), std::logic_error) << call;
}

INSTANTIATE_TEST_SUITE_P(Files, HostileTest, testing::ValuesIn(small_files()),
                         [](const auto& test) { return test.param.name; });

TEST(HostileImageTest, OtherFormatsAreNamedAsSuch) {
  for (const char* text : {"", "GIF89a", "\xff\xd8", "\x89PNG", "RIFF1234WAVEfmt ", "RIFF1234WEB"})
    EXPECT_EQ(refused(bytes_of(text)), "a.img is neither JPEG nor PNG nor WebP nor KTX2");
}

TEST(HostileImageTest, NothingIsSizedByALyingHead) {
  for (const bool progressive : {false, true}) {
    Bytes bytes = jpeg_file(waves(20, 20), {.progressive = progressive});
    const std::size_t at = size_in_jpeg(bytes, progressive ? std::byte{0xc2} : std::byte{0xc0});
    put_big(bytes, at, 2, 60000);
    put_big(bytes, at + 2, 2, 60000);
    EXPECT_THAT(refused(bytes), AllOf(HasSubstr("60000 x 60000"), HasSubstr("65536")));
    const auto reader = open_image(source_of(bytes), "a.img");
    EXPECT_EQ(reader->info().width, 60000U);
    EXPECT_EQ(reader->info().decoder_bytes > 20'000'000'000, progressive);
  }
  EXPECT_THAT(refused(png_of_size(65535, 65535)), HasSubstr("65535 x 65535"));
  EXPECT_EQ(refused(png_of_size(65536, 1)), "a.img: Image width exceeds user limit in IHDR");
  EXPECT_THAT(refused(png_of_size(0, 1)), StartsWith("a.img: "));
}

/// A picture of a head's size whose data soon ends costs what was there.
TEST(HostileImageTest, TallLiesEndWithTheData) {
  const Bytes bytes = png_of_size(2, 65535);
  const auto reader = open_image(source_of(bytes), "a.img");
  std::vector<std::uint8_t> row(6);
  EXPECT_THAT(refusal([&] {
                for (int y = 0; y < 65535; ++y)
                  reader->read_rows(row.data(), 1);
              }),
              StartsWith("a.img: "));
}

/// A WebP file that says that it is 4 GB long.
TEST(HostileImageTest, ALyingLengthIsNoReasonToTakeMemory) {
  Bytes bytes = webp_file(waves(20, 20), 80);
  bytes[7] = std::byte{0xf0};
  EXPECT_THAT(refused(bytes), HasSubstr("ends early"));
}

/// Each scan may cost a pass over all of the picture.
TEST(HostileImageTest, ScansWithoutEndAreRefused) {
  Bytes bytes = jpeg_file(waves(8, 8), {.progressive = true});
  const std::vector<std::byte> mark{std::byte{0xff}, std::byte{0xda}};
  const auto last = std::find_end(bytes.begin(), bytes.end(), mark.begin(), mark.end());
  const Bytes scan(last, bytes.end() - 2);
  for (int i = 0; i < 200; ++i)
    bytes.insert(bytes.end() - 2, scan.begin(), scan.end());
  EXPECT_THAT(refused(bytes), StartsWith("a.img: "));
}

}  // namespace
}  // namespace meshhier::images
