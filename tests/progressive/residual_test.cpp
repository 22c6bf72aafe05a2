#include "progressive/residual.h"

#include "hierarchy/detail.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::progressive {
namespace {

std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values)
    bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

std::vector<std::uint32_t> residuals_of(const AttributeLayout& layout,
                                        const std::vector<float>& values,
                                        const std::vector<float>& predicted) {
  std::vector<std::uint32_t> residuals(values.size());
  find_residuals(layout, values, predicted, residuals);
  return residuals;
}

void expect_round_trip(const AttributeLayout& layout, const std::vector<float>& values,
                       const std::vector<float>& predicted) {
  std::vector<std::uint32_t> residuals = residuals_of(layout, values, predicted);
  std::vector<float> again(values.size());
  add_residuals(layout, residuals, predicted, again);
  ASSERT_EQ(bits_of(again), bits_of(values));
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const int bytes = value_bytes(layout, static_cast<int>(i));
    if (bytes == 4)
      continue;
    ASSERT_LT(residuals[i], std::uint32_t{1} << (8 * bytes)) << "more than is stored";
    residuals[i] |= 0xFFFFFFFFU << (8 * bytes);  // do not count
  }
  add_residuals(layout, residuals, predicted, again);
  ASSERT_EQ(bits_of(again), bits_of(values));
}

/// Each end of each kind of float, with payloads of NaNs.
const std::vector<float>& peculiar_floats() {
  static const std::vector<float> all = [] {
    std::vector<float> floats;
    for (const std::uint32_t bits :
         {0x00000000U, 0x00000001U, 0x007FFFFFU, 0x00800000U, 0x3F800000U, 0x7F7FFFFFU, 0x7F800000U,
          0x7F800001U, 0x7FC00000U, 0x7FC12345U, 0x7FFFFFFFU}) {
      floats.push_back(std::bit_cast<float>(bits));
      floats.push_back(std::bit_cast<float>(bits | 0x80000000U));
    }
    return floats;
  }();
  return all;
}

TEST(Residual, AnyFloatComesBackFromAnyOther) {
  for (const float value : peculiar_floats()) {
    for (const float predicted : peculiar_floats())
      expect_round_trip({}, {value, 1, predicted}, {predicted, 2, value});
  }
}

TEST(Residual, AnyBitsComeBackForAnyLayout) {
  std::mt19937 random(7);
  for (const ColourType colour :
       {ColourType::none, ColourType::u8, ColourType::u16, ColourType::f32}) {
    for (int flags = 0; flags < 8; ++flags) {
      const AttributeLayout layout{(flags & 1) != 0, colour, (flags & 2) != 0, (flags & 4) != 0};
      const auto vertex = [&] {
        std::vector<float> values;
        for (int i = 0; i < vertex_values(layout); ++i) {
          const auto bits = static_cast<std::uint32_t>(random());
          const int bytes = value_bytes(layout, i);
          values.push_back(bytes == 4 ? std::bit_cast<float>(bits)
                                      : static_cast<float>(bits >> (32 - 8 * bytes)));
        }
        return values;
      };
      for (int i = 0; i < 50; ++i)
        expect_round_trip(layout, vertex(), vertex());
    }
  }
}

TEST(Residual, ColoursGoAroundTheEndOfTheirScale) {
  for (const ColourType colour : {ColourType::u8, ColourType::u16}) {
    const AttributeLayout layout{false, colour, false, false};
    const float most = colour == ColourType::u8 ? 255 : 65535;
    for (const float from : {0.0F, 1.0F, 127.0F, 128.0F, most - 1, most}) {
      for (const float to : {0.0F, 1.0F, 127.0F, 128.0F, most - 1, most})
        expect_round_trip(layout, {0, 0, 0, to, from, to}, {0, 0, 0, from, to, to});
    }
    EXPECT_EQ(residuals_of(layout, {0, 0, 0, 0, most, 5}, {0, 0, 0, most, 0, 5}),
              (std::vector<std::uint32_t>{0, 0, 0, 2, 1, 0}));
  }
}

TEST(Residual, SmallDifferencesAreSmallNumbers) {
  for (const float value : {1.0F, -1.0F, 1e-30F, -1e30F, 0.0F, -0.0F}) {
    float above = value, below = value;
    for (std::uint32_t step = 1; step < 100; ++step) {
      above = std::nextafterf(above, std::numeric_limits<float>::infinity());
      below = std::nextafterf(below, -std::numeric_limits<float>::infinity());
      const auto residuals = residuals_of({}, {above, value, below}, {value, value, value});
      EXPECT_LE(residuals[0], 2 * step + 2);
      EXPECT_EQ(residuals[1], 0U);
      EXPECT_LE(residuals[2], 2 * step + 2);
    }
  }
  // The two zeros are neighbours.
  EXPECT_EQ(residuals_of({}, {0.0F, -0.0F, 0.0F}, {-0.0F, 0.0F, 0.0F}),
            (std::vector<std::uint32_t>{2, 1, 0}));
}

}  // namespace
}  // namespace meshhier::progressive
