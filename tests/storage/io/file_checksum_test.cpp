#include "storage/io/file_checksum.h"

#include "base/error.h"
#include "storage/io/hash.h"
#include "tests/support/faulty_file_system.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

constexpr std::size_t kBlock = FileChecksum::kBlockBytes;

std::vector<std::byte> distinct_blocks(std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::byte>((i * 167) ^ (i >> 11));
  return bytes;
}

/// As docs/file_format.md defines it.
std::uint64_t defined(std::span<const std::byte> bytes) {
  std::vector<std::byte> sums;
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(kBlock, bytes.size()))) {
    const std::uint64_t sum = checksum(bytes.first(std::min(kBlock, bytes.size())));
    for (int i = 0; i < 8; ++i)
      sums.push_back(static_cast<std::byte>(sum >> (8 * i)));
  }
  return checksum(sums);
}

class FileChecksumTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("checksum_") + info.name() + std::to_string(::getpid()));
  }
  std::unique_ptr<File> file_of(std::span<const std::byte> bytes) {
    write_file(files_, path_, bytes);
    return files_.open(path_);
  }
  static void go_on() {}

  tests::FaultyFileSystem files_;
  std::filesystem::path path_;
};

TEST_F(FileChecksumTest, IsThatOfTheBlocksChecksums) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kBlock - 1, kBlock, kBlock + 1,
                                 3 * kBlock, 3 * kBlock + 5}) {
    const auto bytes = distinct_blocks(size);
    EXPECT_EQ(FileChecksum(size).complete(*file_of(bytes), go_on), defined(bytes)) << size;
  }
}

TEST_F(FileChecksumTest, TakesWholeBlocksFromReadsOfAnyPlaceAndOrder) {
  const auto bytes = distinct_blocks(5 * kBlock + 77);
  const auto file = file_of(bytes);
  FileChecksum sum(bytes.size());
  const auto add = [&](std::size_t offset, std::size_t size) {
    sum.add(offset, std::span(bytes).subspan(offset, size));
  };
  add(kBlock + 1, kBlock);  // no whole one
  EXPECT_EQ(sum.missing(), 6U);
  add(4 * kBlock - 3, kBlock + 3);
  EXPECT_EQ(sum.missing(), 5U);
  add(5 * kBlock - 1, 78);  // the last one is short
  EXPECT_EQ(sum.missing(), 4U);
  add(100, 3 * kBlock);
  EXPECT_EQ(sum.missing(), 2U);
  add(kBlock, kBlock);  // again
  EXPECT_EQ(sum.missing(), 2U);
  const std::uint64_t before = files_.calls(tests::Call::read);
  EXPECT_EQ(sum.complete(*file, go_on), defined(bytes));
  EXPECT_EQ(files_.calls(tests::Call::read), before + 2);
  EXPECT_EQ(sum.missing(), 0U);
}

TEST_F(FileChecksumTest, WhatSeveralHaveReadIsOneChecksum) {
  const auto bytes = distinct_blocks(5 * kBlock + 77);
  const auto file = file_of(bytes);
  FileChecksum first(bytes.size()), second(bytes.size()), all(bytes.size());
  first.add(0, std::span(bytes).first(kBlock));
  first.add(2 * kBlock, std::span(bytes).subspan(2 * kBlock, 2 * kBlock));
  second.add(3 * kBlock, std::span(bytes).subspan(3 * kBlock));
  ASSERT_EQ(first.known().size(), 2U);
  EXPECT_EQ(first.known()[1].first, 2U);
  EXPECT_EQ(first.known()[1].sums.size(), 2U);
  EXPECT_TRUE(all.known().empty());
  for (const FileChecksum* part : {&first, &second}) {
    for (const BlockSums& sums : part->known())
      EXPECT_TRUE(all.add(sums));
  }
  EXPECT_EQ(all.missing(), 1U);
  EXPECT_EQ(all.complete(*file, go_on), defined(bytes));
  EXPECT_FALSE(all.add({5, {1, 2}}));
  EXPECT_FALSE(all.add({7, {}}));
  EXPECT_TRUE(all.add({6, {}}));
}

TEST_F(FileChecksumTest, EveryBlockCountsInItsPlace) {
  auto bytes = distinct_blocks(3 * kBlock);
  const std::uint64_t sum = defined(bytes);
  for (const std::size_t at : {std::size_t{0}, kBlock + 9, 3 * kBlock - 1}) {
    bytes[at] ^= std::byte{1};
    EXPECT_NE(FileChecksum(bytes.size()).complete(*file_of(bytes), go_on), sum);
    bytes[at] ^= std::byte{1};
  }
  std::swap_ranges(bytes.begin(), bytes.begin() + kBlock, bytes.begin() + kBlock);
  EXPECT_NE(FileChecksum(bytes.size()).complete(*file_of(bytes), go_on), sum);
}

TEST_F(FileChecksumTest, AFailureAndAnInterruptionPassThrough) {
  const auto bytes = distinct_blocks(2 * kBlock);
  const auto file = file_of(bytes);
  EXPECT_THROW(FileChecksum(3 * kBlock).complete(*file, go_on), Error);  // it became shorter
  int calls = 0;
  EXPECT_THROW(FileChecksum(2 * kBlock)
                   .complete(*file,
                             [&] {
                               if (++calls == 2)
                                 throw std::runtime_error("interrupted");
                             }),
               std::runtime_error);
}

}  // namespace
}  // namespace meshhier::storage
