// Means of the quantities that vertices have beside normals, colours and texture coordinates.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/value_channels.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace meshhier {

/// A vertex's channels, as its layout has them, and how much it counts.
struct WeightedVertex {
  const float* channels = nullptr;
  double weight = 0;
};

class ValueMixer {
 public:
  explicit ValueMixer(const AttributeLayout& layout);

  std::span<const PlacedValue> values() const { return values_; }
  bool has_values() const { return !values_.empty(); }
  bool has_labels() const { return has_labels_; }
  bool has_objects() const { return object_.has_value(); }

  /// Puts into the channels of values of `to`, which may be one of the vertices:
  /// * of a quantity the mean, by weight, of those that are finite; if there is none, or no weight,
  ///   the first vertex's. Equal ones stay as they are, bit for bit;
  /// * of a label that with the largest sum of weights, among equal ones the least.
  /// O(v n log n). Requires a vertex, and weights of at least 0.
  void mix(std::span<const WeightedVertex> vertices, float* to) const;

  /// Whether two vertices have the same labels.
  bool have_equal_labels(const float* a, const float* b) const;
  /// Returns the object of a vertex; 0 if there are no objects.
  double object_of(const float* channels) const { return object_ ? object_->in(channels) : 0; }

 private:
  std::vector<PlacedValue> values_;  ///< of all kinds of quantities
  bool has_labels_ = false;
  std::optional<PlacedValue> object_;
};

}  // namespace meshhier
