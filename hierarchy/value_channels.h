// Where the values of vertices lie among their channels.
#pragma once

#include "hierarchy/attributes.h"

#include <cstddef>
#include <vector>

namespace meshhier {

struct PlacedValue {
  ValueType type{};
  bool is_label = false;
  std::size_t channel = 0;  ///< of a vertex, its first one

  std::size_t channels() const { return static_cast<std::size_t>(channels_of(type)); }
};

/// In the order of layout.values.
inline std::vector<PlacedValue> placed_values(const AttributeLayout& layout) {
  std::vector<PlacedValue> placed;
  std::size_t channel = layout.part(AttributeKind::values).first;
  for (const ScalarAttribute& value : layout.values) {
    placed.push_back({value.type, value.is_label, channel});
    channel += placed.back().channels();
  }
  return placed;
}

}  // namespace meshhier
