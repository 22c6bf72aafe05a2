#include "texture/rect_packing.h"

#include "tests/texture/random_numbers.h"

#include <cstdint>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::texture {
namespace {

std::vector<RectSize> random_sizes(std::uint32_t count, std::uint32_t most, unsigned seed) {
  RandomNumbers random(seed);
  std::vector<RectSize> sizes;
  for (std::uint32_t i = 0; i < count; ++i)
    sizes.push_back({1 + random.below(most), 1 + random.below(most)});
  return sizes;
}

/// Each cell of the box is taken at most once, and none lies outside.
void expect_apart(const RectPacking& packing, const std::vector<RectSize>& sizes) {
  ASSERT_EQ(packing.places.size(), sizes.size());
  std::vector<int> taken(std::size_t{packing.width} * packing.height);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const RectPlace& at = packing.places[i];
    ASSERT_LE(at.x + sizes[i].width, packing.width);
    ASSERT_LE(at.y + sizes[i].height, packing.height);
    for (std::uint32_t y = at.y; y < at.y + sizes[i].height; ++y) {
      for (std::uint32_t x = at.x; x < at.x + sizes[i].width; ++x)
        ASSERT_EQ(taken[std::size_t{y} * packing.width + x]++, 0) << i;
    }
  }
}

std::uint64_t area(const std::vector<RectSize>& sizes) {
  std::uint64_t sum = 0;
  for (const RectSize& size : sizes)
    sum += std::uint64_t{size.width} * size.height;
  return sum;
}

TEST(RectPacking, RectanglesLieApartAndClose) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const std::vector<RectSize> sizes = random_sizes(300, 12, seed);
    const std::optional<RectPacking> packing = pack_tightly(sizes, 1024);
    ASSERT_TRUE(packing);
    expect_apart(*packing, sizes);
    EXPECT_LT(double(packing->width) * packing->height, 1.2 * double(area(sizes)));
  }
}

TEST(RectPacking, OneRectangleTakesItsOwnSizeAlone) {
  const std::vector<RectSize> sizes = {{7, 3}};
  const std::optional<RectPacking> packing = pack_tightly(sizes, 1024);
  ASSERT_TRUE(packing);
  EXPECT_EQ(packing->width, 7U);
  EXPECT_EQ(packing->height, 3U);
}

TEST(RectPacking, WhatHasNoRoomIsTold) {
  const std::vector<RectSize> sizes(17, RectSize{4, 4});
  EXPECT_FALSE(pack_into({16, 16}, sizes));
  EXPECT_TRUE(pack_into({16, 20}, sizes));
  EXPECT_FALSE(pack_tightly(sizes, 16));
  EXPECT_FALSE(pack_tightly(std::vector<RectSize>{{17, 1}}, 16));
}

// The library's order of equal elements must not show.
TEST(RectPacking, EqualRectanglesLieInTheirOrder) {
  const std::vector<RectSize> sizes(64, RectSize{2, 2});
  const std::optional<RectPacking> packing = pack_into({16, 16}, sizes);
  ASSERT_TRUE(packing);
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_EQ(packing->places[i].x, 2 * (i % 8));
    EXPECT_EQ(packing->places[i].y, 2 * (i / 8));
  }
}

}  // namespace
}  // namespace meshhier::texture
