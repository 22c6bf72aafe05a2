#include "base/number_text.h"

#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

TEST(NumberText, OneNumberIsTheWholeText) {
  EXPECT_EQ(parse_number<double>("-2.5e3"), -2500);
  EXPECT_EQ(parse_number<std::uint32_t>("4294967295"), 4294967295U);
  for (const char* text : {"", " 1", "1 ", "+1", "1x", "4294967296", "-1", "1.5"})
    EXPECT_EQ(parse_number<std::uint32_t>(text), std::nullopt) << text;
}

TEST(NumberText, SeveralHaveCommasBetween) {
  EXPECT_EQ(parse_numbers("1,-0.5,2e3"), (std::vector<double>{1, -0.5, 2000}));
  EXPECT_EQ(parse_numbers("7"), std::vector<double>{7});
  for (const char* text : {"", ",", "1,", ",1", "1,,2", "1, 2", "1;2", "inf", "1,nan", "1e999"})
    EXPECT_EQ(parse_numbers(text), std::nullopt) << text;
}

}  // namespace
}  // namespace meshhier
