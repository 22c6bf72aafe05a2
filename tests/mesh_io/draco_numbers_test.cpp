#include "mesh_io/draco_numbers.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <draco/attributes/attribute_octahedron_transform.h>
#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/attributes/point_attribute.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint32_t kValues = 4096;
constexpr std::array<float, 3> kLeast{-123.456F, 0.1F, 7e5F};
constexpr float kRange = 99.7F;
constexpr int kBits = 14;

draco::PointAttribute attribute_of(std::int8_t components, draco::DataType type) {
  draco::PointAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, components, type, false, kValues);
  return attribute;
}

/// Number `c` of value `i`, all over what the bits hold.
std::int32_t number_at(std::uint32_t i, std::size_t c) {
  return static_cast<std::int32_t>((i * 2654435761U + c * 40503U) >> 7) & ((1 << kBits) - 2);
}

draco::PointAttribute whole_numbers(std::int8_t components) {
  draco::PointAttribute whole = attribute_of(components, draco::DT_INT32);
  std::array<std::int32_t, 3> numbers{};
  for (std::uint32_t i = 0; i < kValues; ++i) {
    for (std::size_t c = 0; c < numbers.size(); ++c)
      numbers[c] = number_at(i, c);
    whole.SetAttributeValue(draco::AttributeValueIndex(i), numbers.data());
  }
  return whole;
}

std::array<float, 3> floats_at(const draco::PointAttribute& attribute, std::uint32_t i) {
  return attribute.GetValue<float, 3>(draco::AttributeValueIndex(i));
}

TEST(DracoNumbersTest, QuantizedNumbersAreRoundedAfterTheProductAndAfterTheSum) {
  draco::AttributeQuantizationTransform rule;
  ASSERT_TRUE(rule.SetParameters(kBits, kLeast.data(), 3, kRange));
  draco::PointAttribute whole = whole_numbers(3), floats = attribute_of(3, draco::DT_FLOAT32);
  ASSERT_TRUE(rule.TransferToAttribute(&whole));
  compute_floats(&whole, floats);
  const float step = kRange / ((1 << kBits) - 1);
  int fused = 0;
  for (std::uint32_t i = 0; i < kValues; ++i) {
    const auto found = floats_at(floats, i);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto number = static_cast<float>(number_at(i, c));
      // Exact in doubles: a product of 24 bits each has 48.
      const auto product = static_cast<float>(double{number} * step);
      ASSERT_EQ(found[c], static_cast<float>(double{product} + kLeast[c])) << i << " " << c;
      fused += std::fma(number, step, kLeast[c]) != found[c];
    }
  }
  EXPECT_GT(fused, 100) << "no number tells one rounding from two";
}

TEST(DracoNumbersTest, OctahedralNumbersAreUnitVectors) {
  draco::AttributeOctahedronTransform rule;
  rule.SetParameters(kBits);
  draco::PointAttribute whole = attribute_of(2, draco::DT_INT32);
  for (std::uint32_t i = 0; i < kValues; ++i) {
    const std::array numbers{number_at(i, 0), number_at(i, 1)};
    whole.SetAttributeValue(draco::AttributeValueIndex(i), numbers.data());
  }
  ASSERT_TRUE(rule.TransferToAttribute(&whole));
  draco::PointAttribute floats = attribute_of(3, draco::DT_FLOAT32);
  compute_floats(&whole, floats);
  const double middle = ((1 << kBits) - 2) / 2;
  for (std::uint32_t i = 0; i < kValues; ++i) {
    const auto [x, y, z] = floats_at(floats, i);
    EXPECT_NEAR(std::hypot(x, y, z), 1, 1e-6);
    if (x > 0) {  // the half of the octahedron that is not unfolded
      const double sum = std::abs(x) + std::abs(y) + std::abs(z);
      EXPECT_NEAR(y / sum, number_at(i, 0) / middle - 1, 1e-5);
      EXPECT_NEAR(z / sum, number_at(i, 1) / middle - 1, 1e-5);
    }
  }
}

TEST(DracoNumbersTest, NumbersThatTheStreamHoldsAreLeftAsTheyAre) {
  draco::PointAttribute floats = attribute_of(3, draco::DT_FLOAT32);
  const std::array<float, 3> mark{1, 2, 3};
  floats.SetAttributeValue(draco::AttributeValueIndex(5), mark.data());
  const draco::PointAttribute plain = whole_numbers(3);
  compute_floats(nullptr, floats);
  compute_floats(&plain, floats);
  EXPECT_EQ(floats_at(floats, 5), mark);

  draco::AttributeQuantizationTransform rule;
  ASSERT_TRUE(rule.SetParameters(kBits, kLeast.data(), 3, kRange));
  draco::PointAttribute whole = whole_numbers(3), bytes = attribute_of(3, draco::DT_UINT8);
  ASSERT_TRUE(rule.TransferToAttribute(&whole));
  compute_floats(&whole, bytes);
  draco::PointAttribute pairs = attribute_of(2, draco::DT_FLOAT32);
  pairs.SetAttributeValue(draco::AttributeValueIndex(5), mark.data());
  compute_floats(&whole, pairs);
  EXPECT_EQ((pairs.GetValue<float, 2>(draco::AttributeValueIndex(5))),
            (std::array<float, 2>{1, 2}));
}

}  // namespace
}  // namespace meshhier::mesh_io
