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
std::array<double, 4> difference(const AttributeLayout& layout, std::span<const PlacedValue> values,
                                 const VertexAt& a, const VertexAt& b) {
  const auto between = [&](int begin, int end) {
    const auto first = static_cast<std::size_t>(begin),
               count = static_cast<std::size_t>(end) - first;
    return squared_difference(a.attributes().subspan(first, count),
                              b.attributes().subspan(first, count));
  };
  const auto differing = std::ranges::count_if(values, [&](const PlacedValue& value) {
    const int begin = static_cast<int>(value.channel);
    return between(begin, begin + channels_of(value.type)) != 0;
  });
  return {static_cast<double>(differing), between(layout.normal_offset(), layout.colour_offset()),
          between(layout.colour_offset(), layout.value_offset()),
          between(layout.texcoord_offset(), layout.channels())};
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
  const std::vector<PlacedValue> values = placed_values(layout);
  const auto nearest = std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return difference(layout, values, vertex, a) < difference(layout, values, vertex, b);
  });
  return static_cast<std::size_t>(nearest - all.begin());
}

}  // namespace meshhier::exporting
