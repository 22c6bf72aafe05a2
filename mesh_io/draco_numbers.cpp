#include "mesh_io/draco_numbers.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <draco/attributes/attribute_octahedron_transform.h>
#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/attributes/point_attribute.h>
#include <draco/compression/attributes/normal_compression_utils.h>

namespace meshhier::mesh_io {
namespace {

/// Calls `compute(numbers, floats)` for each value; all have as many as the attributes' components.
template <class Compute>
void compute_values(const draco::PointAttribute& whole, draco::PointAttribute& attribute,
                    Compute compute) {
  std::vector<std::int32_t> numbers(whole.num_components());
  std::vector<float> floats(attribute.num_components());
  const auto bytes = static_cast<std::int64_t>(numbers.size() * sizeof(std::int32_t));
  const std::size_t count = std::min(whole.size(), attribute.size());
  if (whole.byte_stride() != bytes)
    return;
  for (std::size_t i = 0; i < count; ++i) {
    const draco::AttributeValueIndex value(static_cast<std::uint32_t>(i));
    whole.GetValue(value, numbers.data());
    compute(std::span<const std::int32_t>(numbers), std::span(floats));
    attribute.SetAttributeValue(value, floats.data());
  }
}

void compute_quantized(const draco::PointAttribute& whole, draco::PointAttribute& attribute) {
  draco::AttributeQuantizationTransform rule;
  if (!rule.InitFromAttribute(whole) || whole.num_components() != attribute.num_components())
    return;
  const std::int32_t largest = (1 << rule.quantization_bits()) - 1;
  const float step = rule.range() / static_cast<float>(largest);
  compute_values(whole, attribute, [&](auto numbers, auto floats) {
    for (std::size_t i = 0; i < floats.size(); ++i)
      floats[i] = static_cast<float>(numbers[i]) * step + rule.min_value(static_cast<int>(i));
  });
}

void compute_directions(const draco::PointAttribute& whole, draco::PointAttribute& attribute) {
  draco::AttributeOctahedronTransform rule;
  draco::OctahedronToolBox octahedron;
  if (!rule.InitFromAttribute(whole) || !octahedron.SetQuantizationBits(rule.quantization_bits()) ||
      whole.num_components() != 2 || attribute.num_components() != 3)
    return;
  compute_values(whole, attribute, [&](auto numbers, auto floats) {
    octahedron.QuantizedOctahedralCoordsToUnitVector(numbers[0], numbers[1], floats.data());
  });
}

}  // namespace

void compute_floats(const draco::PointAttribute* whole, draco::PointAttribute& attribute) {
  const auto* const rule = whole == nullptr ? nullptr : whole->GetAttributeTransformData();
  if (rule == nullptr || attribute.data_type() != draco::DT_FLOAT32)
    return;
  if (rule->transform_type() == draco::ATTRIBUTE_QUANTIZATION_TRANSFORM)
    compute_quantized(*whole, attribute);
  else if (rule->transform_type() == draco::ATTRIBUTE_OCTAHEDRON_TRANSFORM)
    compute_directions(*whole, attribute);
}

}  // namespace meshhier::mesh_io
