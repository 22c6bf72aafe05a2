#include "storage/io/hash.h"

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

std::vector<std::byte> distinct_bytes(std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::byte>((i * 167) ^ (i >> 7));
  return bytes;
}

std::uint64_t checksum_of(std::string_view text) {
  return checksum(std::as_bytes(std::span(text.data(), text.size())));
}

// Published hierarchies carry these sums: they must never change. The values are those of the
// xxHash project's own `xxhsum -H3`.
TEST(Hash, IsXxh3Of64Bits) {
  EXPECT_EQ(checksum({}), 0x2d06800538d394c2u);
  EXPECT_EQ(checksum_of("a"), 0xe6c632b61e964e1fu);
  EXPECT_EQ(checksum_of("abc"), 0x78af5f94892f3950u);
}

// RFC 1321, A.5.
TEST(Hash, KnowsMd5) {
  const auto hex = [](std::string_view text) {
    std::string digits;
    for (const std::byte byte : md5(text)) {
      digits += "0123456789abcdef"[static_cast<unsigned>(byte) >> 4];
      digits += "0123456789abcdef"[static_cast<unsigned>(byte) & 15];
    }
    return digits;
  };
  EXPECT_EQ(hex(""), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(hex("abc"), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(hex("abcdefghijklmnopqrstuvwxyz"), "c3fcd3d76192e4007dfb496cca67e13b");
}

TEST(Hash, OfBlocksIsThatOfTheWhole) {
  const std::vector<std::byte> bytes = distinct_bytes(5000);
  for (const std::size_t block : {1U, 7U, 64U, 240U, 256U, 1023U, 4999U, 5000U}) {
    Checksum sum;
    for (std::size_t at = 0; at < bytes.size(); at += block) {
      sum.add(std::span(bytes).subspan(at, std::min(block, bytes.size() - at)));
      sum.add({});
    }
    EXPECT_EQ(sum.value(), checksum(bytes)) << block;
  }
}

TEST(Hash, OfNoBlocksIsThatOfNothing) {
  EXPECT_EQ(Checksum().value(), checksum({}));
}

TEST(Hash, CanBeAskedOnTheWay) {
  const std::vector<std::byte> bytes = distinct_bytes(3000);
  Checksum sum;
  sum.add(std::span(bytes).first(1000));
  EXPECT_EQ(sum.value(), checksum(std::span(bytes).first(1000)));
  sum.add(std::span(bytes).subspan(1000));
  EXPECT_EQ(sum.value(), checksum(bytes));
}

TEST(Hash, ChangesWithEveryBit) {
  std::vector<std::byte> bytes = distinct_bytes(300);
  std::set<std::uint64_t> sums{checksum(bytes)};
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
    sums.insert(checksum(bytes));
    bytes[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
  }
  EXPECT_EQ(sums.size(), bytes.size() * 8 + 1);
}

}  // namespace
}  // namespace meshhier::storage
