#include "base/widest_corner.h"

#include <array>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

TEST(DoubledAreaTest, IsTwiceThatOfATriangle) {
  EXPECT_DOUBLE_EQ(doubled_area(Vec3f{1, 1, 5}, Vec3f{4, 1, 5}, Vec3f{1, 3, 5}), 6);
  EXPECT_EQ(doubled_area(Vec3f{1, 1, 1}, Vec3f{2, 2, 2}, Vec3f{4, 4, 4}), 0);
  EXPECT_EQ(doubled_area(Vec3f{1, 1, 1}, Vec3f{1, 1, 1}, Vec3f{1, 1, 1}), 0);
}

TEST(DoubledAreaTest, OfANeedleIsThatOfItsShortSide) {
  const std::array<Vec3f, 3> needle = {{{0, 0, 0}, {0, 1, 0}, {1e25F, 2e25F, 3e25F}}};
  const double area = length(cross(Vec3d{0, 1, 0}, to_double(needle[2])));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_DOUBLE_EQ(doubled_area(needle[k], needle[(k + 1) % 3], needle[(k + 2) % 3]), area);
    EXPECT_DOUBLE_EQ(doubled_area(needle[k], needle[(k + 2) % 3], needle[(k + 1) % 3]), area);
  }
}

}  // namespace
}  // namespace meshhier
