// Normals and colours, as far as it takes to tell which of them are alike.
#pragma once

#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attributes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace meshhier::cluster_simplify {

/// A normal of unit length, or a colour as a screen has it, in the range of its type.
using AttributePoint = std::array<double, 4>;

class AttributeKind {
 public:
  /// Without normals, or colours, all are alike.
  static AttributeKind normals(const AttributeLayout& layout, const WedgeOptions& options);
  static AttributeKind colours(const AttributeLayout& layout, const WedgeOptions& options);

  /// Its own of a wedge's attributes.
  std::span<const float> part(std::span<const float> attributes) const {
    return attributes.subspan(offset_, channels_);
  }
  /// Nothing if these say nothing: a normal without a direction, a colour that is not finite.
  std::optional<AttributePoint> point(std::span<const float> part) const;

  /// Larger for what is less alike; limit() is the largest for what may be one.
  double distance(const AttributePoint& a, const AttributePoint& b) const;
  double limit() const { return limit_; }
  /// Whether two parts may not be one; one that says nothing is like any other.
  bool are_apart(std::span<const float> a, std::span<const float> b) const;

  /// The point in the units in which means are taken: a direction, or light.
  AttributePoint summand(const AttributePoint& point) const;
  /// A part again. `sum`: of summands, each times its weight. Nothing if it has no direction, or no
  /// weight.
  std::optional<AttributePoint> mean(const AttributePoint& sum, double weight) const;

 private:
  enum class Numbers { directions, values, light };

  AttributeKind(std::size_t offset, std::size_t channels, Numbers numbers, double range,
                double limit)
      : offset_(offset), channels_(channels), numbers_(numbers), range_(range), limit_(limit) {}

  /// Changes red, green and blue, not opacity.
  template <class Change>
  AttributePoint changed(AttributePoint p, const Change& change) const {
    for (std::size_t k = 0; k < std::min<std::size_t>(channels_, 3); ++k)
      p[k] = range_ * change(p[k] / range_);
    return p;
  }

  std::size_t offset_, channels_;
  Numbers numbers_;
  double range_;  ///< of colours
  double limit_;
};

/// The sum over all channels of their squared differences, those of colours in parts of their
/// range, but those of values. Not finite if a channel is not.
double squared_difference(const AttributeLayout& layout, std::span<const float> a,
                          std::span<const float> b);

}  // namespace meshhier::cluster_simplify
