// Where the values of vertices lie among their channels.
#pragma once

#include "hierarchy/attributes.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace meshhier {

struct PlacedValue {
  ValueType type{};
  bool is_label = false;
  std::size_t channel = 0;  ///< of a vertex, its first one
  bool is_object = false;

  std::size_t channels() const { return static_cast<std::size_t>(channels_of(type)); }
  /// Returns the value of the vertex whose channels begin at `vertex`.
  double in(const float* vertex) const { return value_in(type, vertex + channel); }
};

/// In the order of layout.values.
inline std::vector<PlacedValue> placed_values(const AttributeLayout& layout) {
  std::vector<PlacedValue> placed;
  std::size_t channel = layout.part(AttributeKind::values).first;
  for (const ScalarAttribute& value : layout.values) {
    placed.push_back({value.type, value.is_label, channel, value.is_object});
    channel += placed.back().channels();
  }
  return placed;
}

/// Returns the value that says which object a vertex belongs to; none if nothing says it.
inline std::optional<PlacedValue> placed_object(const AttributeLayout& layout) {
  const std::vector<PlacedValue> placed = placed_values(layout);
  const auto found = std::ranges::find_if(placed, &PlacedValue::is_object);
  return found == placed.end() ? std::nullopt : std::optional(*found);
}

}  // namespace meshhier
