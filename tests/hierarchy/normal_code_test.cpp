#include "hierarchy/normal_code.h"

#include "support/meshes.h"

#include <limits>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

Vec3d random_direction(std::uint64_t index) {
  const Vec3d noise{tests::hash_noise(index, 0), tests::hash_noise(index, 1),
                    tests::hash_noise(index, 2)};
  return noise * (1 / length(noise));
}

TEST(NormalCode, IsOfUnitLengthHoweverLongTheVectorIs) {
  for (std::uint64_t i = 0; i < 20000; ++i) {
    // Lengths near 1 among them: a vector that nearly has unit length is no code for that.
    const double size =
        i % 2 == 0 ? 1 + 0.02 * tests::hash_noise(i, 3) : 1e-6 * static_cast<double>(i);
    const Vec3d direction = random_direction(i);
    const NormalCode code = normal_code(direction * size);
    ASSERT_TRUE(is_normal_code(code)) << i;
    ASSERT_LT(length(to_double(normal_of(code)) - direction), 0.00683) << i;
  }
}

TEST(NormalCode, OfANormalThatCameFromACodeIsThatCode) {
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const NormalCode code = normal_code(random_direction(i));
    ASSERT_EQ(normal_code(to_double(normal_of(code))), code) << i;
  }
}

TEST(NormalCode, WhatHasNoDirectionLooksAlongZ) {
  EXPECT_EQ(normal_code({0, 0, 0}), kNoDirection);
  EXPECT_EQ(normal_code({std::numeric_limits<double>::quiet_NaN(), 1, 0}), kNoDirection);
  EXPECT_EQ(normal_code({std::numeric_limits<double>::infinity(), 1, 0}), kNoDirection);
}

TEST(NormalCode, OtherBytesAreNone) {
  EXPECT_TRUE(is_normal_code({-127, 0, 0, 0}));
  EXPECT_FALSE(is_normal_code({-128, 0, 0, 0}));
  EXPECT_FALSE(is_normal_code({127, 0, 0, 1}));
  EXPECT_FALSE(is_normal_code({126, 0, 0, 0}));
  EXPECT_FALSE(is_normal_code({127, 16, 0, 0}));
  EXPECT_FALSE(is_normal_code({0, 0, 0, 0}));
}

}  // namespace
}  // namespace meshhier
