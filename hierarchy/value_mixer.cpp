#include "hierarchy/value_mixer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace meshhier {
namespace {

/// `value(i)`: of vertex i.
template <class ValueOf>
double mean_of(std::span<const WeightedVertex> vertices, const ValueOf& value) {
  double first = 0, sum = 0, weight = 0;
  bool is_any = false;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double x = value(i);
    if (!std::isfinite(x) || !(vertices[i].weight > 0))
      continue;
    if (!is_any)
      first = x;
    is_any = true;
    sum += (x - first) * vertices[i].weight;  // 0 if all are equal
    weight += vertices[i].weight;
  }
  if (!is_any)
    return value(0);
  return sum == 0 ? first : first + sum / weight;
}

template <class ValueOf>
double label_of(std::span<const WeightedVertex> vertices, const ValueOf& value) {
  double best = value(0), most = -1;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double label = value(i);
    double weight = 0;
    for (std::size_t k = 0; k < vertices.size(); ++k)
      weight += value(k) == label ? vertices[k].weight : 0;
    if (weight > most || (weight == most && label < best)) {
      most = weight;
      best = label;
    }
  }
  return best;
}

}  // namespace

ValueMixer::ValueMixer(const AttributeLayout& layout)
    : values_(placed_values(layout)),
      has_labels_(std::ranges::any_of(values_, &PlacedValue::is_label)) {}

void ValueMixer::mix(std::span<const WeightedVertex> vertices, float* to) const {
  assert(!vertices.empty());
  for (const PlacedValue& value : values_) {
    const auto of = [&](std::size_t i) {
      return value_in(value.type, vertices[i].channels + value.channel);
    };
    put_value(value.type, value.is_label ? label_of(vertices, of) : mean_of(vertices, of),
              to + value.channel);
  }
}

bool ValueMixer::have_equal_labels(const float* a, const float* b) const {
  return std::ranges::all_of(values_, [&](const PlacedValue& value) {
    return !value.is_label ||
           value_in(value.type, a + value.channel) == value_in(value.type, b + value.channel);
  });
}

}  // namespace meshhier
