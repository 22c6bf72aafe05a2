#include "hierarchy/scalar_value.h"

#include "hierarchy/value_mixer.h"
#include "hierarchy/value_statistics.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array kTypes{ValueType::i8,  ValueType::u8,  ValueType::i16, ValueType::u16,
                            ValueType::i32, ValueType::u32, ValueType::f32, ValueType::f64};

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value);
}

double through_channels(ValueType type, double value) {
  std::array<float, 2> channels{};
  put_value(type, value, channels.data());
  return value_in(type, channels.data());
}

TEST(ScalarValue, EveryValueOfATypeComesBackBitForBit) {
  for (const double value : {-128.0, 127.0, 0.0, 1.0})
    EXPECT_EQ(bits(through_channels(ValueType::i8, value)), bits(value));
  for (const double value : {0.0, 65535.0, 257.0})
    EXPECT_EQ(bits(through_channels(ValueType::u16, value)), bits(value));
  for (const double value : {-2147483648.0, 2147483647.0, 16777217.0, -16777217.0})
    EXPECT_EQ(bits(through_channels(ValueType::i32, value)), bits(value));
  EXPECT_EQ(through_channels(ValueType::u32, 4294967295.0), 4294967295.0);
  for (const double value : {1e-310, -0.0, 1.0 / 3, 1e300, kInfinity, -kInfinity, kNan,
                             std::bit_cast<double>(std::uint64_t{0xfff8000000001234})})
    EXPECT_EQ(bits(through_channels(ValueType::f64, value)), bits(value));
  for (const float value : {1.0F / 3, -0.0F, std::numeric_limits<float>::denorm_min()})
    EXPECT_EQ(bits(through_channels(ValueType::f32, value)), bits(value));
}

TEST(ScalarValue, TheNearestOfATypeIsOne) {
  EXPECT_EQ(of_type(ValueType::u8, 255.5), 255);
  EXPECT_EQ(of_type(ValueType::u8, -1), 0);
  EXPECT_FALSE(std::signbit(of_type(ValueType::u8, -0.3)));
  EXPECT_EQ(of_type(ValueType::i16, 7.5), 8);
  EXPECT_EQ(of_type(ValueType::i32, kNan), 0);
  EXPECT_EQ(of_type(ValueType::i32, kInfinity), 2147483647);
  EXPECT_TRUE(std::isnan(of_type(ValueType::f32, kNan)));
  EXPECT_EQ(of_type(ValueType::f32, 0.1), double{0.1F});
}

TEST(ScalarValue, NamesOfTypesComeBack) {
  for (const ValueType type : kTypes)
    EXPECT_EQ(value_type_of(name_of(type)), type);
  EXPECT_FALSE(value_type_of("f16"));
  EXPECT_TRUE(is_attribute_name("scalar_C2M-distance"));
  for (const char* name : {"", "two words", "tab\t", "gr\xc3\xb6\xc3\x9f"})
    EXPECT_FALSE(is_attribute_name(name)) << name;
  EXPECT_FALSE(is_attribute_name(std::string(kMostNameBytes + 1, 'a')));
}

// ---- means

const AttributeLayout kMixed{
    .normals = true,
    .values = {
        {"quality", ValueType::f32}, {"time", ValueType::f64}, {"class", ValueType::i32, true}}};

/// A vertex of kMixed.
std::vector<float> vertex(double quality, double time, double label) {
  std::vector<float> channels(static_cast<std::size_t>(kMixed.channels()));
  put_value(ValueType::f32, quality, channels.data() + 3);
  put_value(ValueType::f64, time, channels.data() + 4);
  put_value(ValueType::i32, label, channels.data() + 6);
  return channels;
}

std::array<double, 3> mixed(const std::vector<std::vector<float>>& vertices,
                            const std::vector<double>& weights) {
  std::vector<WeightedVertex> weighted;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    weighted.push_back({vertices[i].data(), weights[i]});
  std::vector<float> to(static_cast<std::size_t>(kMixed.channels()));
  ValueMixer(kMixed).mix(weighted, to.data());
  return {value_in(ValueType::f32, to.data() + 3), value_in(ValueType::f64, to.data() + 4),
          value_in(ValueType::i32, to.data() + 6)};
}

TEST(ValueMixer, QuantitiesAreAveragedAndLabelsChosen) {
  EXPECT_THAT(mixed({vertex(1, 1e9, 16777217), vertex(5, 3e9, -3)}, {1, 3}),
              ElementsAre(4, 2.5e9, -3));
  EXPECT_THAT(mixed({vertex(1, 1, 7), vertex(1, 1, 9), vertex(1, 1, 7)}, {2, 3, 2}),
              ElementsAre(1, 1, 7));
  EXPECT_EQ(mixed({vertex(1, 1, 9), vertex(1, 1, 7)}, {2, 2})[2], 7) << "the least of equal ones";
}

TEST(ValueMixer, OfManyLabelsItIsTheOneOfMostWeightToo) {
  for (const int count : {15, 16, 17, 200}) {
    std::vector<std::vector<float>> vertices;
    std::vector<double> weights, sums(7);
    for (int i = 0; i < count; ++i) {
      const int label = i * i % 7;
      vertices.push_back(vertex(1, 1, label));
      weights.push_back(0.1 + 0.3 * (i % 5));
      sums[static_cast<std::size_t>(label)] += weights.back();
    }
    const auto most = std::ranges::max_element(sums) - sums.begin();
    EXPECT_EQ(mixed(vertices, weights)[2], static_cast<double>(most)) << count;
    EXPECT_EQ(mixed(vertices, std::vector<double>(vertices.size()))[2], 0) << "the least";
  }
}

TEST(ValueMixer, VeryManyDifferentLabelsTakeNoSquareOfThem) {
  constexpr int kCount = 300'000;  // its square would take a minute
  std::vector<std::vector<float>> vertices;
  for (int i = 0; i < kCount; ++i)
    vertices.push_back(vertex(1, 1, kCount - i));
  EXPECT_EQ(mixed(vertices, std::vector<double>(vertices.size(), 1))[2], 1);
}

TEST(ValueMixer, WhatIsNotFiniteDoesNotCount) {
  const auto some = mixed({vertex(kNan, kInfinity, 1), vertex(5, 3, 1)}, {10, 1});
  EXPECT_EQ(some[0], 5);
  EXPECT_EQ(some[1], 3);
  const auto none = mixed({vertex(kNan, -kInfinity, 1), vertex(kNan, 1, 1)}, {1, 0});
  EXPECT_TRUE(std::isnan(none[0]));
  EXPECT_EQ(none[1], -kInfinity) << "without weight a value does not count";
}

TEST(ValueMixer, EqualValuesStayBitForBit) {
  const double third = 1.0 / 3;
  const auto mean = mixed({vertex(0.1F, third, 1), vertex(0.1F, third, 1), vertex(0.1F, third, 1)},
                          {0.3, 0.7, 1e-9});
  EXPECT_EQ(bits(mean[1]), bits(third));
  EXPECT_EQ(mean[0], double{0.1F});
}

// ---- statistics

ValueStatistics statistics_of(const ScalarAttribute& attribute, std::span<const double> values) {
  std::vector<float> channels;
  const auto width = static_cast<std::size_t>(channels_of(attribute.type));
  for (const double value : values) {
    channels.resize(channels.size() + width);
    put_value(attribute.type, value, channels.data() + channels.size() - width);
  }
  ValueTally tally(attribute);
  tally.add(channels.data(), width, values.size());
  return tally.statistics();
}

TEST(ValueStatistics, BinsHoldEveryFiniteValueOnce) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-300, 300);
  for (int round = 0; round < 200; ++round) {
    const double scale = std::pow(10, exponent(random));
    std::vector<double> values;
    for (int i = 0; i < 300; ++i)
      values.push_back(scale * (std::ldexp(static_cast<double>(random() >> 11), -53) - 0.3));
    const ValueStatistics found = statistics_of({"a", ValueType::f64}, values);
    ASSERT_LE(found.bins.size(), ValueStatistics::kMostBins);
    ASSERT_GT(found.bins.size(), ValueStatistics::kMostBins / 2 - 2) << "bins are not too wide";
    std::vector<std::uint64_t> expected(found.bins.size());
    for (const double value : values) {
      const double bin = std::floor(std::ldexp(value, -found.bin_exponent));
      ++expected.at(static_cast<std::size_t>(static_cast<std::int64_t>(bin) - found.first_bin));
    }
    ASSERT_EQ(found.bins, expected);
    ASSERT_GT(found.bins.front(), 0U);
    ASSERT_GT(found.bins.back(), 0U);
  }
}

TEST(ValueStatistics, PartsInAnyOrderMakeTheSame) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0, 1);
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i)
    values.push_back(i % 97 == 0 ? kNan : std::exp(8 * normal(random)) - 1);
  const ScalarAttribute attribute{"a", ValueType::f64};
  const ValueStatistics whole = statistics_of(attribute, values);
  EXPECT_EQ(whole.missing, 11U);
  for (int round = 0; round < 20; ++round) {
    std::ranges::shuffle(values, random);
    ValueTally joined(attribute);
    for (std::size_t first = 0; first < values.size();) {
      const std::size_t count = std::min<std::size_t>(1 + random() % 200, values.size() - first);
      std::vector<float> channels(2 * count);
      for (std::size_t i = 0; i < count; ++i)
        put_value(ValueType::f64, values[first + i], channels.data() + 2 * i);
      ValueTally part(attribute);
      part.add(channels.data(), 2, count);
      joined.add(part);
      first += count;
    }
    ASSERT_EQ(joined.statistics(), whole);
  }
}

TEST(ValueStatistics, OneValueIsOneBin) {
  for (const double value : {0.0, 1.0, -3e-308, 1e308, -1e9}) {
    const ValueStatistics found = statistics_of({"a", ValueType::f64}, std::vector(5, value));
    EXPECT_EQ(found.min, value);
    EXPECT_EQ(found.max, value);
    EXPECT_THAT(found.bins, ElementsAre(5U)) << value;
  }
}

TEST(ValueStatistics, TheLargestRangeHasBins) {
  const double most = std::numeric_limits<double>::max();
  const std::vector<double> values{-most, 0, most};
  EXPECT_EQ(statistics_of({"a", ValueType::f64}, values).bins.size(), 64U);
}

TEST(ValueStatistics, NothingFiniteIsNothing) {
  const ValueStatistics found =
      statistics_of({"a", ValueType::f32}, std::vector{kNan, kInfinity, -kInfinity});
  EXPECT_EQ(found.missing, 3U);
  EXPECT_THAT(found.bins, IsEmpty());
  EXPECT_EQ(found.min, 0);
}

TEST(ValueStatistics, LabelsAreCountedUnlessThereAreVeryMany) {
  const ScalarAttribute label{"a", ValueType::i32, true};
  const ValueStatistics few = statistics_of(label, std::vector<double>{7, -1, 7, 7});
  EXPECT_THAT(few.labels,
              ElementsAre(ValueStatistics::LabelCount{-1, 1}, ValueStatistics::LabelCount{7, 3}));
  std::vector<double> many;
  for (int i = 0; i < 257; ++i)
    many.push_back(i);
  EXPECT_THAT(statistics_of(label, many).labels, IsEmpty());
  many.pop_back();
  EXPECT_EQ(statistics_of(label, many).labels.size(), 256U);
}

}  // namespace
}  // namespace meshhier::tests
