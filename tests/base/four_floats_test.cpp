#include "base/four_floats.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

std::array<std::int32_t, 4> lanes_of(FourInts four) {
  return {four[0], four[1], four[2], four[3]};
}

/// The lanes whose bits are set in `bits`, as comparisons give them.
FourInts lanes(std::uint32_t bits) {
  FourInts four{};
  for (std::uint32_t i = 0; i < 4; ++i)
    four[i] = (bits >> i & 1) != 0 ? -1 : 0;
  return four;
}

TEST(FourFloatsTest, ComeFromAnywhereAndGoAnywhere) {
  const std::array<float, 6> from = {1, -2, 3.5F, -0.0F, 5, 6};
  for (std::size_t shift = 0; shift < 3; ++shift) {
    const auto four = load_four(&from[shift]);
    std::array<float, 6> to = {9, 9, 9, 9, 9, 9};
    store_four(&to[shift], four);
    for (std::size_t i = 0; i < to.size(); ++i)
      EXPECT_EQ(to[i], i >= shift && i < shift + 4 ? from[i] : 9);
  }
  const std::array<std::uint32_t, 4> ints = {0, 1, 0x80000000U, 0xFFFFFFFFU};
  const auto four = load_four<FourInts>(ints.data());
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(static_cast<std::uint32_t>(four[i]), ints[i]);
}

TEST(FourFloatsTest, TheFirstLaneIsTheLowest) {
  EXPECT_FALSE(any_of(lanes(0)));
  for (std::uint32_t bits = 1; bits < 16; ++bits) {
    EXPECT_TRUE(any_of(lanes(bits))) << bits;
    std::uint32_t first = 0;
    while ((bits >> first & 1) == 0)
      ++first;
    EXPECT_EQ(first_of(lanes(bits)), first) << bits;
  }
}

TEST(FourFloatsTest, FirstLanesAreThoseBelowACount) {
  for (std::int32_t count = -5; count <= 9; ++count) {
    const std::uint32_t expected = (1U << std::clamp(count, 0, 4)) - 1;
    EXPECT_EQ(lanes_of(first_lanes(count)), lanes_of(lanes(expected))) << count;
  }
}

TEST(FourFloatsTest, TheLargestIsFoundInAnyLane) {
  std::array<float, 4> values = {-std::numeric_limits<float>::infinity(), -3, -0.5F, 7};
  do {
    const auto four = load_four(values.data());
    EXPECT_EQ(largest_of(four), 7);
    EXPECT_EQ(largest_of(-four), std::numeric_limits<float>::infinity());
  } while (std::next_permutation(values.begin(), values.end()));
  EXPECT_EQ(largest_of(FourFloats{} - 2.0F), -2);
}

TEST(FourFloatsTest, TheLargerIsFoundLaneByLane) {
  const FourFloats larger = larger_of(FourFloats{1, -1, 5, -8}, FourFloats{2, -3, 5, 0});
  const std::array<float, 4> expected = {2, -1, 5, 0};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(larger[i], expected[i]);
}

TEST(FourFloatsTest, SumsArePairsFirst) {
  // Two are lost beside 2^25, four are not.
  EXPECT_EQ(sum_of(FourFloats{0x1p25F, 0, 2, 2}), 0x1p25F + 4);
  EXPECT_EQ(sum_of(FourFloats{1, 2, 3, 4}), 10);
}

}  // namespace
}  // namespace meshhier
