#include "storage/format/gzip.h"

#include "base/error.h"
#include "storage/format/glb.h"
#include "tests/support/error_message.h"

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using storage::gunzip_glb;
using storage::gzip;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

Bytes sample_glb(std::size_t bin_bytes) {
  Bytes bin(bin_bytes);
  std::mt19937 random(3);
  for (std::byte& byte : bin)
    byte = static_cast<std::byte>(random() % 7);
  return storage::join_glb("{}", bin);
}

std::string failure(const Bytes& bytes) {
  return tests::error_message(
      ErrorCode::corrupt, [&] { gunzip_glb(bytes, "some/tile.glb"); }, "some/tile.glb: ");
}

TEST(GzipTest, GivesBackWhatWentIn) {
  for (const std::size_t size : {0U, 4U, 1000U, 300000U}) {
    const Bytes glb = sample_glb(size);
    EXPECT_EQ(gunzip_glb(gzip(glb), "a.glb"), glb);
  }
  EXPECT_LT(gzip(sample_glb(300000)).size(), 150000U);
}

TEST(GzipTest, TheHeaderTellsNeitherTimeNorSystem) {
  const Bytes packed = gzip(sample_glb(100));
  const auto head = [&](std::size_t i) { return std::to_integer<int>(packed[i]); };
  EXPECT_EQ(head(0), 0x1f);
  EXPECT_EQ(head(1), 0x8b);
  EXPECT_EQ(head(2), 8);  // deflate
  for (const std::size_t i : {3U, 4U, 5U, 6U, 7U})
    EXPECT_EQ(head(i), 0) << i;
  EXPECT_EQ(head(9), 255);
}

TEST(GzipTest, SANITIZED_TruncationAtEveryByteIsRefused) {
  const Bytes packed = gzip(sample_glb(500));
  for (std::size_t size = 0; size < packed.size(); ++size) {
    const Bytes cut(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(failure(cut), "") << size;
  }
}

TEST(GzipTest, SANITIZED_EveryFlippedBitIsRefusedOrHarmless) {
  const Bytes glb = sample_glb(500);
  const Bytes packed = gzip(glb);
  for (std::size_t bit = 0; bit < 8 * packed.size(); ++bit) {
    Bytes damaged = packed;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
    if (failure(damaged).empty()) {
      EXPECT_EQ(gunzip_glb(damaged, "a.glb"), glb) << bit;
    }
  }
}

TEST(GzipTest, SANITIZED_WhatFollowsIsRefused) {
  Bytes packed = gzip(sample_glb(500));
  packed.push_back(std::byte{0});
  EXPECT_THAT(failure(packed), HasSubstr("1 bytes after the gzip stream"));
}

TEST(GzipTest, SANITIZED_LengthsThatAreNotTheStreamsAreRefused) {
  const auto with_length = [](std::uint32_t length) {
    Bytes glb = sample_glb(500);
    storage::store_little(length, glb.data() + 8);
    return failure(gzip(glb));
  };
  const auto size = static_cast<std::uint32_t>(sample_glb(500).size());
  EXPECT_EQ(with_length(size), "");
  EXPECT_THAT(with_length(0), HasSubstr("tells 0 bytes"));
  EXPECT_THAT(with_length(size - 4), HasSubstr("goes on after"));
  EXPECT_THAT(with_length(size + 4), HasSubstr("ends after"));
  EXPECT_THAT(with_length(UINT32_MAX), HasSubstr("cannot hold"));
}

TEST(GzipTest, SANITIZED_OtherFilesAreRefused) {
  EXPECT_THAT(failure(sample_glb(100)), HasSubstr("is no gzip stream"));
  EXPECT_THAT(failure({}), HasSubstr("ends after 0 bytes"));
}

}  // namespace
}  // namespace meshhier::tests
