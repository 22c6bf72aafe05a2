#include "base/union_find.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

TEST(UnionFindTest, SetsAreNamedByTheirLeastElementWhateverTheOrder) {
  UnionFind sets(6);
  EXPECT_TRUE(sets.join(5, 3));
  EXPECT_TRUE(sets.join(4, 5));
  EXPECT_FALSE(sets.join(3, 4));
  EXPECT_EQ(sets.find(5), 3U);
  EXPECT_EQ(sets.find(4), 3U);
  EXPECT_TRUE(sets.join(4, 1));
  for (const std::uint32_t v : {1U, 3U, 4U, 5U})
    EXPECT_EQ(sets.find(v), 1U);
  EXPECT_EQ(sets.find(0), 0U);
  EXPECT_EQ(sets.find(2), 2U);
}

TEST(UnionFindTest, AChainOfAMillionIsOneSet) {
  constexpr std::uint32_t kCount = 1000000;
  UnionFind sets(kCount);
  for (std::uint32_t v = kCount - 1; v > 0; --v)
    EXPECT_TRUE(sets.join(v, v - 1));
  EXPECT_EQ(sets.find(kCount - 1), 0U);
}

}  // namespace
}  // namespace meshhier
