#include "pipeline/label_guess.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::size_t kVertices = 10'000;

LabelGuess guess_of(ValueType type, bool is_label, const std::vector<float>& values,
                    std::size_t block = 3000) {
  const ScalarAttribute attribute{"a", type, is_label};
  LabelGuess all(attribute);
  for (std::size_t first = 0; first < values.size(); first += block) {
    LabelGuess part(attribute);
    part.add(values.data() + first, 1, std::min(block, values.size() - first));
    all.add(part);
  }
  return all;
}

/// One number for each vertex.
template <class Value>
std::vector<float> values_of(const Value& value, std::size_t count = kVertices) {
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(static_cast<float>(value(i)));
  return values;
}

TEST(LabelGuess, IntensitiesAreNoLabels) {
  std::mt19937 random(3);
  const auto noise = values_of([&](std::size_t) { return random() % 4000; });
  EXPECT_TRUE(guess_of(ValueType::u16, true, noise).is_quantity());
  EXPECT_TRUE(
      guess_of(ValueType::i16, true, values_of([](std::size_t i) { return i; })).is_quantity());
  EXPECT_FALSE(guess_of(ValueType::u16, false, noise).is_quantity()) << "is one already";
  EXPECT_FALSE(guess_of(ValueType::f32, true, noise).is_quantity()) << "its label was asked for";
}

TEST(LabelGuess, WhatLiesTogetherOrIsOfFewKindsStaysALabel) {
  std::mt19937 random(5);
  const auto objects = values_of([](std::size_t i) { return i / 10; });
  EXPECT_FALSE(guess_of(ValueType::u16, true, objects).is_quantity());
  const auto bytes = values_of([&](std::size_t) { return random() % 256; });
  EXPECT_FALSE(guess_of(ValueType::u8, true, bytes).is_quantity());
  const auto few = values_of([](std::size_t i) { return i; }, 4000);
  EXPECT_FALSE(guess_of(ValueType::u16, true, few).is_quantity());
}

TEST(LabelGuess, FewWholeNumbersMayBeClasses) {
  const auto classes = values_of([](std::size_t i) { return i % 7 == 0 ? 6 : 2; });
  EXPECT_THAT(guess_of(ValueType::f32, false, classes).classes(), ElementsAre(2, 6));
  EXPECT_THAT(guess_of(ValueType::f32, true, classes).classes(), IsEmpty()) << "is one";
  EXPECT_THAT(guess_of(ValueType::u8, false, classes).classes(), IsEmpty()) << "asked for";
  auto some = classes;
  some[17] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(guess_of(ValueType::f32, false, some).classes(), ElementsAre(2, 6));
}

TEST(LabelGuess, OtherNumbersAreNoClasses) {
  const auto classes = [](const auto& value) {
    return guess_of(ValueType::f32, false, values_of(value)).classes();
  };
  EXPECT_THAT(classes([](std::size_t i) { return i == 9000 ? 2.5 : 2; }), IsEmpty());
  EXPECT_THAT(classes([](std::size_t i) { return i == 0 ? -1 : 2; }), IsEmpty());
  EXPECT_THAT(classes([](std::size_t i) { return i == 0 ? 4096 : 2; }), IsEmpty());
  EXPECT_THAT(classes([](std::size_t) { return 2; }), IsEmpty()) << "means change nothing";
  EXPECT_THAT(classes([](std::size_t i) { return i % 65; }), IsEmpty()) << "many";
  EXPECT_EQ(classes([](std::size_t i) { return i % 64; }).size(), 64U);
}

TEST(LabelGuess, TheLineOfTheConfigIsJson) {
  EXPECT_EQ(labels_line({"class", "a\"b"}), R"("labels": ["class", "a\"b"])");
}

}  // namespace
}  // namespace meshhier::pipeline
