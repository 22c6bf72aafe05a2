#include "storage/format/index.h"

#include "base/error.h"
#include "storage/format/glb.h"
#include "storage/io/hash.h"
#include "tests/support/error_message.h"

#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using storage::decode_index;
using storage::encode_index;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

const char* const kIndexName = "some/tiles.bin";
constexpr std::size_t kHeaderBytes = 32;
constexpr std::size_t kRecordBytes = 120;

/// Every tile of the tree, with values that differ from field to field and from tile to tile.
std::vector<TileRecord> make_records(const Tree& tree) {
  std::vector<TileRecord> records;
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    for (std::uint32_t i = 0; i < tree.node_count(static_cast<Level>(level)); ++i) {
      const NodeId node{static_cast<Level>(level), i};
      if (tree.is_early(node))
        continue;
      const auto k = static_cast<std::uint32_t>(records.size());
      const auto real = static_cast<float>(k);
      TileRecord record;
      record.node = node;
      record.own_count =
          static_cast<std::uint32_t>(tree.is_partition(node) ? tree.ranks(node).size() : 100 + k);
      record.boundary_count = record.own_count / 3;
      record.ghost_count = 10 * k + 1;
      record.copy_count = 10 * k + 7;
      record.split_count = 10 * k + 8;
      record.interior_count = 10 * k + 2;
      record.border_count = 10 * k + 3;
      record.drawn_border_count = 10 * k;
      record.target_count = 10 * k + 4;
      record.torn_count = 10 * k + 5;
      record.forced_count = 10 * k + 6;
      record.error = real + 0.1F;
      record.bound = real + 0.2F;
      record.compactness = real + 0.3F;
      record.image_width = k % 3 * 4096;
      record.image_height = k % 3 * (k + 1);
      record.texel = k % 3 == 1 ? real + 0.4F : 0;
      record.bounds = {{-real, -2, -3}, {1, real + 2, 3}};
      record.file_bytes = 1000000007ULL * (k + 1);
      record.checksum = 0x0123456789abcdefULL * (k + 1);
      records.push_back(record);
    }
  }
  return records;
}

void expect_same(const TileRecord& a, const TileRecord& b) {
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.own_count, b.own_count);
  EXPECT_EQ(a.boundary_count, b.boundary_count);
  EXPECT_EQ(a.ghost_count, b.ghost_count);
  EXPECT_EQ(a.copy_count, b.copy_count);
  EXPECT_EQ(a.split_count, b.split_count);
  EXPECT_EQ(a.interior_count, b.interior_count);
  EXPECT_EQ(a.border_count, b.border_count);
  EXPECT_EQ(a.drawn_border_count, b.drawn_border_count);
  EXPECT_EQ(a.target_count, b.target_count);
  EXPECT_EQ(a.torn_count, b.torn_count);
  EXPECT_EQ(a.forced_count, b.forced_count);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.bound, b.bound);
  EXPECT_EQ(a.compactness, b.compactness);
  EXPECT_EQ(a.image_width, b.image_width);
  EXPECT_EQ(a.image_height, b.image_height);
  EXPECT_EQ(a.texel, b.texel);
  EXPECT_EQ(a.bounds, b.bounds);
  EXPECT_EQ(a.file_bytes, b.file_bytes);
  EXPECT_EQ(a.checksum, b.checksum);
}

/// Makes the checksum fit the bytes again, so that what is behind it is reached.
Bytes sealed(Bytes bytes) {
  storage::Checksum sum;
  sum.add(std::span(bytes).first(24));
  sum.add(std::span(bytes).subspan(kHeaderBytes));
  storage::store_little(sum.value(), bytes.data() + 24);
  return bytes;
}

std::string failure(const Bytes& bytes, const Tree& tree) {
  return tests::error_message(
      ErrorCode::corrupt, [&] { decode_index(bytes, tree, kIndexName); }, kIndexName);
}

TEST(Index, GivesEveryRecordBack) {
  for (const std::uint32_t partitions : {1U, 2U, 3U, 5U, 8U, 21U, 100U}) {
    const Tree tree(1003, partitions);
    const auto records = make_records(tree);
    EXPECT_EQ(records.size(), tree.tile_count());
    const Bytes bytes = encode_index(records);
    EXPECT_EQ(bytes.size(), kHeaderBytes + kRecordBytes * records.size());
    const auto back = decode_index(bytes, tree, kIndexName);
    ASSERT_EQ(back.size(), records.size());
    for (std::size_t i = 0; i < back.size(); ++i)
      expect_same(records[i], back[i]);
  }
}

TEST(Index, TheBytesAreThoseOfTheDocument) {
  const Tree tree(7, 1);
  TileRecord record;
  record.own_count = 7;
  record.boundary_count = 5;
  record.copy_count = 258;
  record.interior_count = 100;
  record.split_count = 259;
  record.image_width = 0x1234;
  record.image_height = 0x102;
  record.texel = 0.5F;
  record.error = 1.0F;
  record.bounds = {{0, 0, 0}, {1, 1, 1}};
  record.file_bytes = 0x0102030405060708;
  const Bytes bytes = encode_index(std::vector{record});
  const auto byte = [&](std::size_t offset) { return static_cast<int>(bytes.at(offset)); };
  EXPECT_EQ(byte(0), 'M');
  EXPECT_EQ(byte(7), '\n');
  EXPECT_EQ(byte(8), 4);
  EXPECT_EQ(byte(12), 120);
  EXPECT_EQ(byte(16), 1);
  EXPECT_EQ(byte(kHeaderBytes + 8), 7);
  EXPECT_EQ(byte(kHeaderBytes + 12), 5);
  EXPECT_EQ(byte(kHeaderBytes + 20), 2);
  EXPECT_EQ(byte(kHeaderBytes + 21), 1);
  EXPECT_EQ(byte(kHeaderBytes + 51), 0x3F);  // 1.0F is 3F800000
  EXPECT_EQ(byte(kHeaderBytes + 50), 0x80);
  EXPECT_EQ(byte(kHeaderBytes + 84), 3);
  EXPECT_EQ(byte(kHeaderBytes + 85), 1);
  EXPECT_EQ(byte(kHeaderBytes + 88), 0x34);
  EXPECT_EQ(byte(kHeaderBytes + 92), 2);
  EXPECT_EQ(byte(kHeaderBytes + 99), 0x3F);
  EXPECT_EQ(byte(kHeaderBytes + 104), 8);
  EXPECT_EQ(byte(kHeaderBytes + 111), 1);
}

TEST(Index, SANITIZED_TruncationAndExtraBytesAreRefused) {
  const Tree tree(50, 5);
  Bytes bytes = encode_index(make_records(tree));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(failure(cut, tree), "") << size;
  }
  bytes.push_back(std::byte{0});
  EXPECT_THAT(failure(bytes, tree), HasSubstr("expected 1112"));
}

TEST(Index, SANITIZED_EveryFlippedBitIsFound) {
  const Tree tree(50, 3);
  Bytes bytes = encode_index(make_records(tree));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
    EXPECT_NE(failure(bytes, tree), "") << bit;
    bytes[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
  }
}

TEST(Index, SANITIZED_FlipsBehindAFittingChecksumNeverCrash) {
  const Tree tree(50, 5);
  const Bytes good = encode_index(make_records(tree));
  std::mt19937 random(3);
  for (int round = 0; round < 5000; ++round) {
    Bytes bytes = good;
    bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
    const Bytes again = sealed(bytes);
    if (failure(again, tree).empty()) {
      EXPECT_EQ(encode_index(decode_index(again, tree, kIndexName)), again);
    }
  }
}

TEST(Index, APictureNeedsTriangles) {
  const Tree tree(7, 1);
  TileRecord record;
  record.own_count = 7;
  record.bounds = {{0, 0, 0}, {1, 1, 1}};
  record.file_bytes = 1;
  record.image_width = record.image_height = 64;
  EXPECT_THAT(failure(encode_index(std::vector{record}), tree), HasSubstr("of no triangle"));
  record.border_count = 1;
  EXPECT_EQ(failure(encode_index(std::vector{record}), tree), "");
}

struct RecordDamage {
  std::size_t offset;  ///< in the first record
  std::uint32_t value;
  const char* message;
};

TEST(Index, SANITIZED_ImpossibleValuesAreRefusedByName) {
  constexpr std::uint32_t kNan = 0x7FC00000;
  constexpr std::uint32_t kMinusOne = 0xBF800000;
  const Tree tree(50, 5);
  const Bytes good = encode_index(make_records(tree));
  for (const RecordDamage& damage :
       {RecordDamage{0, 3, "record 0 is of tile 3/0, expected 0/0"},
        RecordDamage{0, 256, "record 0 is of tile 256/0"},
        RecordDamage{4, 1, "record 0 is of tile 0/1"},
        RecordDamage{8, 0, "impossible own vertices"},
        RecordDamage{8, 32769, "impossible own vertices"},
        RecordDamage{12, 101, "impossible boundary vertices"},
        RecordDamage{32, 4, "impossible drawn border"}, RecordDamage{48, kNan, "impossible error"},
        RecordDamage{52, kMinusOne, "impossible bound"},
        RecordDamage{56, kNan, "impossible compactness"},
        RecordDamage{60, 0x7F800000, "impossible bounds"},
        RecordDamage{72, 0xC0000000, "impossible bounds"},
        RecordDamage{84, 3 * (2 + 3) + 1, "impossible splits"},
        RecordDamage{88, 1, "impossible size of the picture"},
        RecordDamage{92, 1, "impossible size of the picture"},
        RecordDamage{96, 1, "impossible texel"}, RecordDamage{96, kNan, "impossible texel"},
        RecordDamage{100, 1, "bytes that have to be 0 are not"}}) {
    Bytes bytes = good;
    storage::store_little(damage.value, bytes.data() + kHeaderBytes + damage.offset);
    EXPECT_THAT(failure(sealed(bytes), tree), HasSubstr(damage.message));
  }
  for (const RecordDamage& damage :
       {RecordDamage{88, 0, "impossible size of the picture"},
        RecordDamage{92, 0, "impossible size of the picture"},
        RecordDamage{88, kMaxImageSide + 1, "impossible size of the picture"},
        RecordDamage{92, kMaxImageSide + 1, "impossible size of the picture"},
        RecordDamage{96, kMinusOne, "impossible texel"}, RecordDamage{88, kMaxImageSide, ""},
        RecordDamage{96, 0, ""}}) {
    Bytes bytes = good;
    storage::store_little(damage.value, bytes.data() + kHeaderBytes + kRecordBytes + damage.offset);
    EXPECT_THAT(failure(sealed(bytes), tree), HasSubstr(damage.message));
    EXPECT_EQ(failure(sealed(bytes), tree).empty(), *damage.message == '\0');
  }
  Bytes partition = good;
  storage::store_little(11U, partition.data() + partition.size() - kRecordBytes + 8);
  EXPECT_THAT(failure(sealed(partition), tree), HasSubstr("not the partition's"));
}

TEST(Index, NormalMapsHaveTheirOwnVersion) {
  const Tree tree(50, 5);
  std::vector<TileRecord> records = make_records(tree);
  const Bytes without = encode_index(records);
  EXPECT_EQ(without[8], std::byte{4});
  records[1].image_width = 64;
  records[1].image_height = 60;
  records[1].texel = 0.5F;
  records[1].interior_count = std::max(records[1].interior_count, 1U);
  records[1].has_normal_map = true;
  const Bytes with = encode_index(records);
  EXPECT_EQ(with[8], std::byte{5});
  EXPECT_TRUE(decode_index(with, tree, "some/tiles.bin")[1].has_normal_map);
  EXPECT_FALSE(decode_index(with, tree, "some/tiles.bin")[0].has_normal_map);
  records[1].image_width = records[1].image_height = 0;
  records[1].texel = 0;
  EXPECT_THAT(failure(encode_index(records), tree), HasSubstr("impossible normal map"));
  Bytes earlier = with;
  earlier[8] = std::byte{4};
  EXPECT_THAT(failure(sealed(earlier), tree), HasSubstr("bytes that have to be 0 are not"));
}

TEST(Index, SANITIZED_OtherFilesAndVersionsAreRefused) {
  const Tree tree(50, 5);
  const Bytes good = encode_index(make_records(tree));
  Bytes bytes = good;
  bytes[8] = std::byte{6};
  EXPECT_THAT(failure(bytes, tree), HasSubstr("version is 6, expected 4 or 5 (written by a newer"));
  bytes[8] = std::byte{3};
  EXPECT_THAT(failure(bytes, tree), HasSubstr("version is 3, expected 4 or 5"));
  bytes = good;
  bytes[0] = std::byte{'P'};
  EXPECT_THAT(failure(bytes, tree), HasSubstr("not an index"));
  EXPECT_THAT(failure(good, Tree(50, 6)), HasSubstr("9 records, expected 11 for 6 partitions"));
}

}  // namespace
}  // namespace meshhier::tests
