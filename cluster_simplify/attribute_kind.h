// Normals and colours, as far as it takes to tell which of them are alike.
#pragma once

#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attributes.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace meshhier::cluster_simplify {

/// A normal of unit length, or a colour.
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
  /// Of two parts; what says nothing is like everything.
  bool are_apart(std::span<const float> a, std::span<const float> b) const;

  /// `sum`: of points, each times its weight. Nothing if it has no direction, or no weight.
  std::optional<AttributePoint> mean(const AttributePoint& sum, double weight) const;

 private:
  AttributeKind(std::size_t offset, std::size_t channels, bool is_direction, double limit)
      : offset_(offset), channels_(channels), is_direction_(is_direction), limit_(limit) {}

  std::size_t offset_, channels_;
  bool is_direction_;
  double limit_;
};

/// The sum over all channels of their squared differences, those of colours in parts of their
/// range. Not finite if a channel is not.
double squared_difference(const AttributeLayout& layout, std::span<const float> a,
                          std::span<const float> b);

}  // namespace meshhier::cluster_simplify
