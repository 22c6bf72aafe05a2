#include "base/half_space.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

constexpr std::array<Vec3d, 3> kTriangle{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}};

TEST(HalfSpaceTest, ABoxIsTouchedByWhatHasAPointInIt) {
  const std::vector<BoundsD> touched{
      {{-9, -9, -9}, {9, 9, 9}},   {{0.2, -1, 0.2}, {0.3, 1, 0.3}},    {{1, 0, 0}, {2, 2, 2}},
      {{-9, 0, -9}, {9, 1, 9}},    {{0.25, 0, 0.25}, {0.25, 0, 0.25}}, {{0.3, -1, 0.7}, {2, 1, 2}},
      {{-9, -9, 0.1}, {9, 9, 0.1}}};
  for (const BoundsD& box : touched)
    EXPECT_TRUE(touches(half_spaces_of(box), kTriangle)) << box.min.x << ' ' << box.max.z;
  const std::vector<BoundsD> missed{
      {{1.001, -9, -9}, {9, 9, 9}}, {{0.301, -1, 0.7}, {2, 1, 2}}, {{-9, 1e-12, -9}, {9, 1, 9}}};
  for (const BoundsD& box : missed)
    EXPECT_FALSE(touches(half_spaces_of(box), kTriangle)) << box.min.x << ' ' << box.min.y;
}

TEST(HalfSpaceTest, ACornerOrAnEdgeOnASlantedFaceIsEnough) {
  EXPECT_TRUE(touches(std::array{HalfSpace{{-1, 0, -1}, -1}}, kTriangle));
  EXPECT_FALSE(touches(std::array{HalfSpace{{-1, 0, -1}, -1.001}}, kTriangle));
  EXPECT_TRUE(touches({}, kTriangle));
}

}  // namespace
}  // namespace meshhier
