#include "mesh_io/number_text.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

TEST(NumberText, Integers) {
  EXPECT_EQ(parse_integer("0"), 0);
  EXPECT_EQ(parse_integer("007"), 7);
  EXPECT_EQ(parse_integer("+12"), 12);
  EXPECT_EQ(parse_integer("-12"), -12);
  EXPECT_EQ(parse_integer("999999999999999999"), 999999999999999999);
  EXPECT_EQ(parse_integer("9223372036854775807"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(parse_integer("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
  for (const char* text : {"", "-", "+", "+-1", "-+1", "--1", "1.0", "1e3", "0x10", "12a", "a12",
                           " 1", "9223372036854775808", "-9223372036854775809"}) {
    EXPECT_EQ(parse_integer(text), std::nullopt) << text;
  }
}

TEST(NumberText, Reals) {
  EXPECT_EQ(parse_real<float>("1.5"), 1.5F);
  EXPECT_EQ(parse_real<float>("+1.5e+2"), 150.0F);
  EXPECT_EQ(parse_real<double>("-.5E-1"), -0.05);
  EXPECT_EQ(parse_real<double>("7."), 7.0);
  EXPECT_EQ(parse_real<double>("42"), 42.0);
  for (const char* text : {"", "+", "-", ".", "e5", "1e", "1e+", "+-1", "--1", "1,5", "0x10", "1f",
                           "1 ", "1.#", "infinite"}) {
    EXPECT_EQ(parse_real<double>(text), std::nullopt) << text;
    EXPECT_EQ(parse_real<float>(text), std::nullopt) << text;
  }
}

TEST(NumberText, NotFinite) {
  for (const char* text :
       {"nan", "NaN", "-nan", "+NAN", "-nan(ind)", "1.#QNAN", "-1.#IND00", "1.#INF"}) {
    const auto value = parse_real<float>(text);
    ASSERT_TRUE(value) << text;
    EXPECT_TRUE(std::isnan(*value)) << text;
  }
  for (const char* text : {"inf", "+inf", "Infinity", "INF"}) {
    EXPECT_EQ(parse_real<double>(text), std::numeric_limits<double>::infinity()) << text;
  }
  EXPECT_EQ(parse_real<double>("-inf"), -std::numeric_limits<double>::infinity());
}

TEST(NumberText, OutOfRangeIsInfiniteOrZero) {
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(parse_real<float>("1e39"), infinity);
  EXPECT_EQ(parse_real<float>("-3.5e38"), -infinity);
  EXPECT_EQ(parse_real<float>("1" + std::string(60, '0')), infinity);
  EXPECT_EQ(parse_real<float>("1" + std::string(80, '0') + "e-10"), infinity);
  EXPECT_EQ(parse_real<float>("0.0001e50"), infinity);
  EXPECT_EQ(parse_real<float>("1e99999999999999999999"), infinity);
  EXPECT_EQ(parse_real<float>("1e-50"), 0.0F);
  EXPECT_EQ(parse_real<float>("12345e-60"), 0.0F);
  EXPECT_EQ(parse_real<float>("0." + std::string(60, '0') + "1"), 0.0F);
  EXPECT_EQ(parse_real<float>("0." + std::string(100, '0') + "1e5"), 0.0F);
  EXPECT_EQ(parse_real<double>("1e-99999999999999999999"), 0.0);
  EXPECT_TRUE(std::signbit(*parse_real<float>("-1e-50")));
  EXPECT_EQ(parse_real<double>("1e400"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_real<float>("1e-40"), 1e-40F) << "denormals are exact";
}

TEST(NumberText, EveryShortestFloatComesBackBitForBit) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    const auto bits = static_cast<std::uint32_t>(random());
    const float value = std::bit_cast<float>(bits);
    if (!std::isfinite(value))
      continue;
    const auto parsed = parse_real<float>(fmt::format("{}", value));
    ASSERT_TRUE(parsed);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(*parsed), bits) << value;
  }
}

TEST(NumberText, WhatWasWrittenFromAFloatFitsOne) {
  std::mt19937 random(8);
  for (int i = 0; i < 20000; ++i) {
    const auto bits = static_cast<std::uint32_t>(random());
    const float value = std::bit_cast<float>(bits);
    if (!std::isfinite(value))
      continue;
    std::vector<std::string> texts{fmt::format("{:.9g}", value), fmt::format("{:.12e}", value)};
    if (std::abs(value) < 0x1p24F)  // above, digits before the point are filled up with zeros
      texts.push_back(fmt::format("{}", value));
    for (const std::string& text : texts) {
      const auto parsed = parse_decimal(text);
      ASSERT_TRUE(parsed && parsed->fits_float) << text;
      EXPECT_EQ(std::bit_cast<std::uint32_t>(static_cast<float>(parsed->value)), bits) << text;
    }
  }
}

TEST(NumberText, WhatAFloatRoundsFitsNone) {
  for (const char* text : {"400123.123", "16777217", "0.12345678901", "1e39", "3.4028236e38",
                           "1.00000000001", "123456789012", "0.1234567890123456789012345", "1e-60",
                           "0.9999999999999999", "1.0000000000000002", "1.000000000000001"})
    EXPECT_FALSE(parse_decimal(text)->fits_float) << text;
  for (const char* text : {"0", "-0", "0.1", "-.5", "3.", "1e10", "1E-3", "16777216", "0.100000",
                           "123.456", "-266108.438", "0e-60", "+7"})
    EXPECT_TRUE(parse_decimal(text)->fits_float) << text;
  EXPECT_EQ(parse_decimal("400123.123")->value, 400123.123);
  EXPECT_FALSE(parse_decimal("1x"));
}

}  // namespace
}  // namespace meshhier::mesh_io
