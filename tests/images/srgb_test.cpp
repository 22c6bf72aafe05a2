#include "images/srgb.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

TEST(SrgbTest, AgreesWithTheStandard) {
  for (int value = 0; value < 256; ++value) {
    const double v = value / 255.0;
    const double light = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    ASSERT_NEAR(light_of(v), light, 1e-15) << value;
    ASSERT_EQ(screen_value(light), value);
    ASSERT_EQ(screen_value(light_of((value - 0.49) / 255)), value);
    ASSERT_EQ(screen_value(light_of((value + 0.49) / 255)), value);
  }
}

TEST(SrgbTest, WhatIsNoLightIsCut) {
  EXPECT_EQ(screen_value(-1), 0);
  EXPECT_EQ(screen_value(std::nan("")), 0);
  EXPECT_EQ(screen_value(2), 255);
  EXPECT_EQ(light_of(std::nan("")), 0);
  EXPECT_EQ(light_of(-3), 0);
  EXPECT_EQ(light_of(70000), 1);
}

TEST(LightTableTest, EveryValueComesBack) {
  const LightTable& table = LightTable::get();
  for (int value = 0; value < 256; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    ASSERT_EQ(table.value(table.light(byte)), byte);
    ASSERT_NEAR(table.light(byte), 65535 * light_of(value / 255.0), 0.5);
  }
  EXPECT_EQ(table.light(255), 65535U);
}

TEST(LightTableTest, MoreLightIsNoLowerValue) {
  const LightTable& table = LightTable::get();
  for (std::uint32_t light = 1; light <= 65535; ++light)
    ASSERT_LE(table.value(light - 1), table.value(light));
}

}  // namespace
}  // namespace meshhier::images
