#include "hierarchy/triangle.h"

#include "hierarchy/ids.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using TileCorners = Triangle<TileVertex>;

TileCorners corners(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return {TileVertex{a}, TileVertex{b}, TileVertex{c}};
}

// Triangles of different ids are different types.
static_assert(!std::is_convertible_v<Triangle<TileVertex>, Triangle<VertexId>>);
static_assert(!std::is_convertible_v<Triangle<TileVertex>, Triangle<std::uint32_t>>);
// Spools and files hold them as they are.
static_assert(std::is_trivially_copyable_v<TileCorners> && sizeof(TileCorners) == 12);

TEST(TriangleForm, CanonicalTurnsTheSmallestCornerToTheFrontAndKeepsOrientation) {
  for (const TileCorners& t : {corners(1, 5, 9), corners(5, 9, 1), corners(9, 1, 5)}) {
    EXPECT_EQ(canonical(t), corners(1, 5, 9));
  }
  for (const TileCorners& t : {corners(1, 9, 5), corners(9, 5, 1), corners(5, 1, 9)}) {
    EXPECT_EQ(canonical(t), corners(1, 9, 5));
  }
}

TEST(TriangleForm, TwoEqualCornersAreDegenerate) {
  EXPECT_TRUE(is_degenerate(corners(3, 3, 4)));
  EXPECT_TRUE(is_degenerate(corners(4, 3, 3)));
  EXPECT_TRUE(is_degenerate(corners(3, 4, 3)));
  EXPECT_TRUE(is_degenerate(corners(3, 3, 3)));
  EXPECT_FALSE(is_degenerate(corners(3, 4, 5)));
}

TEST(TriangleForm, TheSmallestCornerIsFoundInEveryPlace) {
  EXPECT_EQ(smallest_corner(corners(1, 5, 9)), 0U);
  EXPECT_EQ(smallest_corner(corners(5, 1, 9)), 1U);
  EXPECT_EQ(smallest_corner(corners(5, 9, 1)), 2U);
  EXPECT_EQ(smallest_corner(corners(1, 1, 2)), 0U);
  EXPECT_EQ(smallest_corner(corners(2, 1, 1)), 0U) << "there twice";
  EXPECT_EQ(smallest_corner(corners(1, 2, 1)), 0U) << "there twice";
}

TEST(TriangleForm, TurningKeepsTheOrderOfCorners) {
  const Triangle<std::uint64_t> t{7, 8, 9};
  EXPECT_EQ(turned(t, 0), t);
  EXPECT_EQ(turned(t, 1), (Triangle<std::uint64_t>{8, 9, 7}));
  EXPECT_EQ(turned(t, 2), (Triangle<std::uint64_t>{9, 7, 8}));
}

}  // namespace
}  // namespace meshhier::tests
