#include "cluster_simplify/local_frame.h"

#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using Limits = std::numeric_limits<float>;

float largest(const std::vector<Vec3f>& positions) {
  float result = 0;
  for (const Vec3f p : positions)
    result = std::max({result, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return result;
}

std::vector<Vec3f> scaled(std::vector<Vec3f> positions, float factor, Vec3f shift = {}) {
  for (Vec3f& p : positions)
    p = p * factor + shift;
  return positions;
}

TEST(LocalFrameTest, TheLongestHalfIsBetweenOneHalfAndOne) {
  for (const float unit : {1.0F, 0.3F, 1e-30F, 1e30F, 7e-42F, 3e38F}) {
    const std::vector<Vec3f> positions = scaled(tests::sphere(200, 0.1F).positions, unit);
    const float size = largest(LocalFrame(bounds_of(positions)).to_local(positions));
    EXPECT_GE(size, 0.5F) << unit;
    EXPECT_LE(size, 1.0F) << unit;
  }
}

TEST(LocalFrameTest, LiesAboutTheMiddleOfTheBox) {
  const std::vector<Vec3f> positions = {{10, 20, 30}, {16, 22, 31}, {11, 21, 30}};
  const LocalFrame frame(bounds_of(positions));
  const std::vector<Vec3f> local = frame.to_local(positions);
  EXPECT_EQ(local[0], (Vec3f{-0.75F, -0.25F, -0.125F}));
  EXPECT_EQ(local[1], (Vec3f{0.75F, 0.25F, 0.125F}));
  EXPECT_EQ(local[2], (Vec3f{-0.5F, 0, -0.125F}));
  EXPECT_EQ(frame.to_global(Vec3f{}), (Vec3f{13, 21, 30.5F}));
}

TEST(LocalFrameTest, ThereAndBackIsTheSamePlaceUpToALocalRounding) {
  for (const Vec3f shift : {Vec3f{}, Vec3f{1000, -3, 0.5F}}) {
    const std::vector<Vec3f> positions = scaled(tests::torus(300, 0.1F).positions, 0.7F, shift);
    const LocalFrame frame(bounds_of(positions));
    const std::vector<Vec3f> local = frame.to_local(positions);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      // Half a unit in the last place of 1, once in the frame and once in the coordinate.
      const double tolerance = 2 * Limits::epsilon() * std::max(1.0F, largest({positions[i]}));
      ASSERT_LE(tests::distance(frame.to_global(local[i]), positions[i]), tolerance);
    }
  }
}

TEST(LocalFrameTest, PowersOfTwoChangeNothing) {
  const std::vector<Vec3f> positions = tests::sphere(200, 0.1F).positions;
  const std::vector<Vec3f> local = LocalFrame(bounds_of(positions)).to_local(positions);
  for (const int power : {-80, -1, 1, 3, 90}) {
    const std::vector<Vec3f> others = scaled(positions, std::exp2(static_cast<float>(power)));
    EXPECT_EQ(LocalFrame(bounds_of(others)).to_local(others), local) << power;
  }
}

TEST(LocalFrameTest, LosesNoDigitsFarFromZero) {
  // Steps of 1/16 at 10^6, which floats hold exactly there.
  std::vector<Vec3f> positions;
  for (int i = 0; i <= 96; ++i)
    positions.push_back({1e6F + static_cast<float>(i) / 16, -1e6F, 5e5F});
  const LocalFrame frame(bounds_of(positions));
  const std::vector<Vec3f> local = frame.to_local(positions);
  for (int i = 0; i <= 96; ++i) {
    EXPECT_EQ(local[i], (Vec3f{(static_cast<float>(i) / 16 - 3) / 4, 0, 0}));
    EXPECT_EQ(frame.to_global(local[i]), positions[i]);
  }
}

TEST(LocalFrameTest, OnePlaceIsItsOwnMiddle) {
  for (const Vec3f p : {Vec3f{3, 4, 5}, Vec3f{}, Vec3f{Limits::max(), -Limits::max(), 1},
                        Vec3f{Limits::denorm_min(), 0, 0}}) {
    const std::vector<Vec3f> positions(5, p);
    const LocalFrame frame(bounds_of(positions));
    EXPECT_THAT(frame.to_local(positions), testing::Each(Vec3f{}));
    EXPECT_EQ(frame.to_global(Vec3f{}), p);
  }
}

TEST(LocalFrameTest, NoPlacesNeedNoFrame) {
  const LocalFrame frame(Bounds{});
  EXPECT_TRUE(frame.to_local(std::span<const Vec3f>{}).empty());
  EXPECT_EQ(frame.to_global(Vec3f{1, 2, 3}), (Vec3f{1, 2, 3}));
}

TEST(LocalFrameTest, TheEndsOfFloatAreWithinReach) {
  const std::vector<Vec3f> positions = {{-Limits::max(), 0, 0}, {Limits::max(), 1, 0}};
  const LocalFrame frame(bounds_of(positions));
  const std::vector<Vec3f> local = frame.to_local(positions);
  EXPECT_LE(largest(local), 1);
  EXPECT_EQ(frame.to_global(local[0]).x, -Limits::max());
  EXPECT_EQ(frame.to_global(local[1]).x, Limits::max());
  EXPECT_EQ(frame.to_global(Vec3f{1.5F, -1.5F, 2}),
            (Vec3f{Limits::max(), -Limits::max(), Limits::max()}));
}

}  // namespace
}  // namespace meshhier::cluster_simplify
