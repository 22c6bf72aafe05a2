#include "hierarchy/value_mixer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

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

/// Labels of a few vertices are compared each with each, which needs no memory.
constexpr std::size_t kFewVertices = 16;

template <class ValueOf>
double label_of_few(std::span<const WeightedVertex> vertices, const ValueOf& value) {
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

/// The same of any number: sums are of the same weights in the same order.
template <class ValueOf>
double label_of_many(std::span<const WeightedVertex> vertices, const ValueOf& value) {
  std::vector<std::pair<double, std::size_t>> labels;  // those that are numbers, and whose
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (const double label = value(i); !std::isnan(label))
      labels.emplace_back(label, i);
  }
  std::ranges::sort(labels);
  double best = value(0), most = std::isnan(best) ? 0 : -1;
  for (std::size_t i = 0; i < labels.size();) {
    const double label = labels[i].first;
    double weight = 0;
    for (; i < labels.size() && labels[i].first == label; ++i)
      weight += vertices[labels[i].second].weight;
    if (weight > most) {
      most = weight;
      best = label;
    }
  }
  return best;
}

template <class ValueOf>
double label_of(std::span<const WeightedVertex> vertices, const ValueOf& value) {
  return vertices.size() <= kFewVertices ? label_of_few(vertices, value)
                                         : label_of_many(vertices, value);
}

/// The values, and each number of other kinds of quantities.
std::vector<PlacedValue> quantities_of(const AttributeLayout& layout) {
  std::vector<PlacedValue> quantities = placed_values(layout);
  for (const AttributePart& part : layout.parts()) {
    if (part.kind == AttributeKind::values || row_of(part.kind).rule != AttributeRule::quantities)
      continue;
    for (std::size_t k = part.first; k < part.end(); ++k)
      quantities.push_back({ValueType::f32, false, k});
  }
  return quantities;
}

}  // namespace

ValueMixer::ValueMixer(const AttributeLayout& layout)
    : values_(quantities_of(layout)),
      has_labels_(std::ranges::any_of(values_, &PlacedValue::is_label)),
      object_(placed_object(layout)) {}

void ValueMixer::mix(std::span<const WeightedVertex> vertices, float* to) const {
  assert(!vertices.empty());
  for (const PlacedValue& value : values_) {
    const auto of = [&](std::size_t i) { return value.in(vertices[i].channels); };
    put_value(value.type, value.is_label ? label_of(vertices, of) : mean_of(vertices, of),
              to + value.channel);
  }
}

bool ValueMixer::have_equal_labels(const float* a, const float* b) const {
  return std::ranges::all_of(values_, [&](const PlacedValue& value) {
    return !value.is_label || value.in(a) == value.in(b);
  });
}

}  // namespace meshhier
