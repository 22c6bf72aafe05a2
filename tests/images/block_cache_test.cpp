#include "images/block_cache.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

std::vector<std::byte> block(std::uint64_t key) {
  return std::vector<std::byte>(1000, static_cast<std::byte>(key));
}

bool has(BlockCache& cache, std::uint64_t key) {
  return cache.use(key, [&](const std::byte* bytes) {
    for (std::size_t i = 0; i < 1000; ++i)
      ASSERT_EQ(bytes[i], static_cast<std::byte>(key));
  });
}

/// The keys of 0 ... 99 that are there.
std::vector<std::uint64_t> held(BlockCache& cache) {
  std::vector<std::uint64_t> keys;
  for (std::uint64_t key = 0; key < 100; ++key) {
    if (has(cache, key))
      keys.push_back(key);
  }
  return keys;
}

TEST(BlockCacheTest, TheLeastRecentlyUsedGoesFirst) {
  BlockCache cache(3 * 1200);
  for (const std::uint64_t key : {1, 2, 3})
    cache.put(key, block(key));
  EXPECT_TRUE(has(cache, 1));
  cache.put(4, block(4));
  EXPECT_EQ(held(cache), (std::vector<std::uint64_t>{1, 3, 4}));
}

TEST(BlockCacheTest, HoldsNoMoreThanItMay) {
  for (const std::uint64_t most : {0, 999, 1100, 5000, 40'000}) {
    BlockCache cache(most);
    for (std::uint64_t key = 0; key < 100; ++key)
      cache.put(key, block(key));
    EXPECT_LE(held(cache).size() * 1000, most);
    EXPECT_GE((held(cache).size() + 1) * 1200, most);
  }
}

TEST(BlockCacheTest, ABlockIsHeldOnce) {
  BlockCache cache(3 * 1200);
  for (int i = 0; i < 10; ++i)
    cache.put(1, block(1));
  cache.put(2, block(2));
  cache.put(3, block(3));
  EXPECT_EQ(held(cache), (std::vector<std::uint64_t>{1, 2, 3}));
}

TEST(BlockCacheTest, LargeOnesArePartedAndStillHoldMost) {
  BlockCache cache(64 << 20);
  for (std::uint64_t key = 0; key < 100; ++key)
    cache.put(key, block(key));
  EXPECT_EQ(held(cache).size(), 100U);
}

}  // namespace
}  // namespace meshhier::images
