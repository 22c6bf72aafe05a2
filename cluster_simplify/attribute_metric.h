// How far normals, or colours, of wedges are apart, and what stands for several that are alike.
#pragma once

#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attribute_rules.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// A direction of unit length, or a colour as a screen has it, in the range of its type.
using AttributePoint = std::array<double, 4>;

constexpr bool is_measured(const AttributeKindRow& row) {
  return row.rule == AttributeRule::direction || row.rule == AttributeRule::colour;
}
/// So many kinds have a metric.
inline constexpr auto kMeasuredKinds =
    static_cast<std::size_t>(std::ranges::count_if(kAttributeKinds, is_measured));

class AttributeMetric {
 public:
  /// `part`: of a kind that is_measured().
  AttributeMetric(const AttributePart& part, const AttributeRules& rules,
                  const WedgeOptions& options);

  /// The channels that it measures.
  const AttributePart& channels() const { return channels_; }
  /// Its own of a wedge's attributes.
  std::span<const float> part(std::span<const float> attributes) const {
    return channels_.of(attributes);
  }
  /// Nothing if these say nothing: a normal without a direction, a colour that is not finite.
  std::optional<AttributePoint> point(std::span<const float> part) const;

  /// Larger for what is less alike; limit() is the largest for what may be one.
  double distance(const AttributePoint& a, const AttributePoint& b) const;
  double limit() const { return limit_; }
  /// Whether the parts of two wedges may not be one; one that says nothing is like any other.
  bool are_apart(std::span<const float> a, std::span<const float> b) const;

  /// The point in the units in which means are taken: a direction, or light.
  AttributePoint summand(const AttributePoint& point) const;
  /// A part again. `sum`: of summands, each times its weight. Nothing if it has no direction, or no
  /// weight.
  std::optional<AttributePoint> mean(const AttributePoint& sum, double weight) const;

 private:
  /// Changes red, green and blue, not opacity.
  template <class Change>
  AttributePoint changed(AttributePoint p, const Change& change) const {
    for (std::size_t k = 0; k < std::min<std::size_t>(channels_.count, 3); ++k)
      p[k] = range_ * change(p[k] / range_);
    return p;
  }

  AttributePart channels_;
  bool are_directions_;
  bool are_light_;  ///< of colours
  double range_;    ///< of colours
  double limit_;
};

/// One for each kind that the layout has and that is_measured(), in their order.
std::vector<AttributeMetric> metrics_of(const AttributeRules& rules, const WedgeOptions& options);

/// The sum over all channels of their squared differences, those of colours in parts of their
/// range, but those of quantities. Not finite if a channel is not.
double squared_difference(const AttributeRules& rules, std::span<const float> a,
                          std::span<const float> b);

}  // namespace meshhier::cluster_simplify
