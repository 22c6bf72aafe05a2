#include "hierarchy/length.h"

#include <optional>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

TEST(Length, IsANumberPerhapsWithAUnit) {
  EXPECT_EQ(parse_length("2m")->unit, Unit::m);
  EXPECT_EQ(parse_length("-0.5us_ft")->unit, Unit::us_ft);
  EXPECT_EQ(parse_length("1e3")->number, 1000);
  EXPECT_EQ(parse_length("1e3")->unit, std::nullopt);
  for (const char* text : {"", "m", "2 m", "2M", "2mm ", "inf", "nan", "1e999m", "2m3", "2mi"})
    EXPECT_FALSE(parse_length(text)) << text;
}

TEST(Length, BecomesAnotherUnitWithoutNoise) {
  EXPECT_EQ(parse_length("7cm")->in(1), 0.07);
  EXPECT_EQ(parse_length("3m")->in(0.001), 3000);
  EXPECT_EQ(parse_length("0.3km")->in(0.01), 30000);
  EXPECT_EQ(parse_length("10ft")->in(1), 3.048);
  EXPECT_EQ(parse_length("0.25")->in(0.001), 0.25);
}

}  // namespace
}  // namespace meshhier
