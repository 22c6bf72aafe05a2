// Axis-aligned bounding boxes.
#pragma once

#include "base/vec.h"

#include <limits>
#include <span>

namespace meshhier {

template <class Scalar>
struct BoundsOf {
  Vec3<Scalar> min{kHigh, kHigh, kHigh};
  Vec3<Scalar> max{-kHigh, -kHigh, -kHigh};

  static constexpr Scalar kHigh = std::numeric_limits<Scalar>::max();

  constexpr bool empty() const { return min.x > max.x; }
  constexpr void add(Vec3<Scalar> p) {
    min = {p.x < min.x ? p.x : min.x, p.y < min.y ? p.y : min.y, p.z < min.z ? p.z : min.z};
    max = {p.x > max.x ? p.x : max.x, p.y > max.y ? p.y : max.y, p.z > max.z ? p.z : max.z};
  }
  constexpr void add(const BoundsOf& other) {
    if (!other.empty()) {
      add(other.min);
      add(other.max);
    }
  }
  friend constexpr bool operator==(const BoundsOf&, const BoundsOf&) = default;
};

using Bounds = BoundsOf<float>;
using BoundsD = BoundsOf<double>;

/// The box of `points`; empty() if there are none. O(n).
Bounds bounds_of(std::span<const Vec3f> points);

/// Length of the box's diagonal in input units; 0 if empty.
double diagonal(const Bounds& bounds);

}  // namespace meshhier
