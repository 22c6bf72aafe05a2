#include "export/nearest_vertex.h"

#include "hierarchy/value_channels.h"

#include <algorithm>
#include <array>

namespace meshhier::exporting {
namespace {

double squared_difference(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += (double{a[i]} - double{b[i]}) * (double{a[i]} - double{b[i]});
  return sum;
}

/// Returns how unlike two vertices are: by values, normal, colour, texture coordinate.
using Difference = std::array<double, 1 + kAttributeKindCount>;

Difference difference(const AttributeParts& parts, std::span<const PlacedValue> values,
                      const VertexAt& a, const VertexAt& b) {
  const auto between = [&](const AttributePart& part) {
    return squared_difference(part.of(a.attributes()), part.of(b.attributes()));
  };
  Difference difference{};
  difference[0] = static_cast<double>(std::ranges::count_if(values, [&](const PlacedValue& value) {
    return between({AttributeKind::values, value.channel, value.channels()}) != 0;
  }));
  for (const AttributePart& part : parts) {
    if (part.kind != AttributeKind::values)
      difference[1 + static_cast<std::size_t>(part.kind)] = between(part);
  }
  return difference;
}

}  // namespace

std::vector<VertexAt> vertices_at(const VertexArray& vertices, const Copies& copies,
                                  std::uint32_t place) {
  std::vector<VertexAt> all{VertexAt(vertices, place)};
  for (std::size_t i = copies.first_of(place); i < copies.size() && copies.places[i] == place; ++i)
    all.push_back(VertexAt(copies.vertices, i));
  return all;
}

std::size_t nearest_vertex(const AttributeLayout& layout, const VertexAt& vertex,
                           std::span<const VertexAt> all) {
  if (all.size() == 1)
    return 0;
  const AttributeParts parts = layout.parts();
  const std::vector<PlacedValue> values = placed_values(layout);
  const auto nearest = std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return difference(parts, values, vertex, a) < difference(parts, values, vertex, b);
  });
  return static_cast<std::size_t>(nearest - all.begin());
}

}  // namespace meshhier::exporting
