#include "execution/size_text.h"

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::execution {
namespace {

constexpr std::uint64_t kMebi = std::uint64_t{1} << 20;

TEST(ParseSize, PlainNumbersAreBytes) {
  EXPECT_EQ(parse_size("0"), 0u);
  EXPECT_EQ(parse_size("1"), 1u);
  EXPECT_EQ(parse_size("1000"), 1000u);
  EXPECT_EQ(parse_size("77B"), 77u);
}

TEST(ParseSize, BinaryUnitsArePowersOf1024) {
  EXPECT_EQ(parse_size("3KiB"), 3072u);
  EXPECT_EQ(parse_size("512MiB"), 512 * kMebi);
  EXPECT_EQ(parse_size("2GiB"), 2048 * kMebi);
  EXPECT_EQ(parse_size("4TiB"), 4 * kMebi * kMebi);
  EXPECT_EQ(parse_size("512M"), 512 * kMebi);
  EXPECT_EQ(parse_size("2g"), 2048 * kMebi);
}

TEST(ParseSize, DecimalUnitsArePowersOf1000) {
  EXPECT_EQ(parse_size("5kB"), 5000u);
  EXPECT_EQ(parse_size("5KB"), 5000u);
  EXPECT_EQ(parse_size("512MB"), 512'000'000u);
  EXPECT_EQ(parse_size("3GB"), 3'000'000'000u);
  EXPECT_EQ(parse_size("2TB"), 2'000'000'000'000u);
}

TEST(ParseSize, FractionsSpacesAndCase) {
  EXPECT_EQ(parse_size("1.5GiB"), 1536 * kMebi);
  EXPECT_EQ(parse_size(" 512 mib "), 512 * kMebi);
  EXPECT_EQ(parse_size("0.3"), 0u);
  EXPECT_EQ(parse_size("1.9B"), 1u);
}

TEST(ParseSize, RefusesEverythingElse) {
  for (const char* text : {"", " ", "MiB", "-1", "+1", "-1MiB", "1 2", "12MiBs", "12XB", "0x10",
                           "1e3", "nan", "inf", "1,5GiB", ".5GiB", "512 Mi B", "--", "1GiB1"}) {
    EXPECT_EQ(parse_size(text), std::nullopt) << '"' << text << '"';
  }
}

TEST(ParseSize, RefusesWhatIsTooLargeToBeExact) {
  EXPECT_EQ(parse_size("9007199254740991"), 9007199254740991u);
  EXPECT_EQ(parse_size("9007199254740992"), std::nullopt);
  EXPECT_EQ(parse_size("8191TiB"), 8191 * kMebi * kMebi);
  EXPECT_EQ(parse_size("8192TiB"), std::nullopt);
  EXPECT_EQ(parse_size("99999999999999999999999999GiB"), std::nullopt);
  EXPECT_EQ(parse_size(std::string(400, '9')), std::nullopt);
}

TEST(ExactSizeText, IsShortAndReadsBack) {
  EXPECT_EQ(exact_size_text(0), "0");
  EXPECT_EQ(exact_size_text(1000), "1000");
  EXPECT_EQ(exact_size_text(20'000'000), "20MB");
  EXPECT_EQ(exact_size_text(1024), "1KiB");
  EXPECT_EQ(exact_size_text(512 * kMebi), "512MiB");
  EXPECT_EQ(exact_size_text(1024 * kMebi), "1GiB");
  EXPECT_EQ(exact_size_text(1536 * kMebi), "1536MiB");
  EXPECT_EQ(exact_size_text(2048 * kMebi * kMebi), "2048TiB");
  for (const std::uint64_t bytes :
       {std::uint64_t{1}, std::uint64_t{1023}, std::uint64_t{1025}, 7 * kMebi, kMebi * kMebi,
        std::uint64_t{15'000'000}, kMebi + 1, (std::uint64_t{1} << 53) - 1}) {
    EXPECT_EQ(parse_size(exact_size_text(bytes)), bytes);
  }
}

TEST(RoundedSizeText, HasThreeDigits) {
  EXPECT_EQ(rounded_size_text(0), "0 B");
  EXPECT_EQ(rounded_size_text(999), "999 B");
  EXPECT_EQ(rounded_size_text(1000), "0.98 KiB");
  EXPECT_EQ(rounded_size_text(1024), "1.00 KiB");
  EXPECT_EQ(rounded_size_text(1536), "1.50 KiB");
  EXPECT_EQ(rounded_size_text(10 * 1024), "10.0 KiB");
  EXPECT_EQ(rounded_size_text(100 * kMebi), "100 MiB");
  EXPECT_EQ(rounded_size_text(1000 * kMebi), "0.98 GiB");
  EXPECT_EQ(rounded_size_text(2048 * kMebi * kMebi), "2048 TiB");
}

}  // namespace
}  // namespace meshhier::execution
