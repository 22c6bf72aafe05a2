#include "export/nearest_vertex.h"

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

Difference difference(const AttributeRules& rules, const VertexAt& a, const VertexAt& b) {
  const auto between = [&](const AttributePart& part) {
    return squared_difference(part.of(a.attributes()), part.of(b.attributes()));
  };
  Difference difference{};
  const auto differs = [&](const PlacedValue& value) {
    return between({AttributeKind::values, value.channel, value.channels()}) != 0;
  };
  difference[0] = static_cast<double>(std::ranges::count_if(rules.values().values(), differs));
  for (const AttributePart& part : rules.parts()) {
    if (!AttributeRules::are_quantities(part))
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

std::size_t nearest_vertex(const AttributeRules& rules, const VertexAt& vertex,
                           std::span<const VertexAt> all) {
  if (all.size() == 1)
    return 0;
  const auto nearest = std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return difference(rules, vertex, a) < difference(rules, vertex, b);
  });
  return static_cast<std::size_t>(nearest - all.begin());
}

}  // namespace meshhier::exporting
