#include "base/srgb.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace meshhier {
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

TEST(SrgbTest, ValuesOf16BitsComeBackFromLightAsFloats) {
  for (int value = 0; value <= 65535; ++value) {
    const auto light = static_cast<float>(light_of(value / 65535.0));
    ASSERT_EQ(std::lround(65535 * value_of(light)), value);
  }
}

TEST(SrgbTest, ALightsValueIsTheStandards) {
  for (int i = 0; i <= 100'000; ++i) {
    const double light = i / 100'000.0;
    const double value =
        light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    ASSERT_NEAR(value_of(light), value, 1e-14) << light;
  }
  for (const double none : {-1.0, std::nan(""), 0.0})
    EXPECT_EQ(value_of(none), 0);
  for (const double full : {1.0, 7.0, HUGE_VAL})
    EXPECT_EQ(value_of(full), 1);
}

TEST(LightCurveTest, IsNearTheStandardAndUndoesItself) {
  const LightCurve& curve = LightCurve::get();
  for (int i = 0; i <= 100'000; ++i) {
    const double value = i / 100'000.0;
    ASSERT_NEAR(curve.light(value), light_of(value), 4e-7);
    ASSERT_NEAR(curve.value(curve.light(value)), value, 1e-12);
    ASSERT_EQ(static_cast<float>(255 * curve.value(curve.light(i % 256 / 255.0))), i % 256);
  }
  for (const double none : {-1.0, std::nan("")}) {
    EXPECT_EQ(curve.light(none), 0);
    EXPECT_EQ(curve.value(none), 0);
  }
  for (const double full : {1.0, 7.0, HUGE_VAL}) {
    EXPECT_EQ(curve.light(full), 1);
    EXPECT_EQ(curve.value(full), 1);
  }
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
}  // namespace meshhier
