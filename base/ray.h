// Rays, and where they meet boxes and triangles.
//
// Problem. A ray must not slip through the edge that two triangles share, however it is rounded;
// and a tree of boxes must find what trying all triangles finds, to the bit.
//
// Idea. A triangle is tested in coordinates in which the ray is an axis: its three edges are then
// lines in a plane, and the ray is on a side of each (Woop, Benthin & Wald, Watertight Ray/Triangle
// Intersection, 2013). The side of an edge is the same number for both triangles that have it, but
// for its sign. A hit lies within the triangle's own box, which is tested as boxes around it are:
//
//       entry                 exit             box within box: the entry is no earlier, the exit
//    ----[====[======]=========]---->          no later, with all rounding
//          entry    exit
//
// Invariant. span() is monotone: every operation is, as floating point rounds monotonically. So a
// box that is left out because it is missed, or entered behind a hit, holds no hit that counts.
#pragma once

#include "base/vec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace meshhier {

/// Two numbers at a time. Operations on them are those of single ones, bit for bit.
using TwoDoubles = double __attribute__((vector_size(16)));

/// A half-line, prepared for tests.
class Ray {
 public:
  /// `direction`: of unit length, about. Requires finite numbers.
  Ray(Vec3d origin, Vec3d direction);

  const Vec3d& origin() const { return origin_; }
  const Vec3d& direction() const { return direction_; }
  Vec3d at(double distance) const { return origin_ + direction_ * distance; }

  /// `Real`: double, or TwoDoubles of two boxes.
  template <class Real>
  struct SpanOf {
    Real entry, exit;  ///< distances along the ray; below 0 behind its origin
    auto is_empty() const { return !((entry <= exit) & (exit >= 0.0)); }
  };
  using Span = SpanOf<double>;
  /// Returns where the ray is in a box, made larger by what rounding may do to a hit; empty if it
  /// misses it.
  template <class Scalar>
  Span span(const Vec3<Scalar>& low, const Vec3<Scalar>& high) const {
    return span_in(std::array<double, 3>{low.x, low.y, low.z},
                   std::array<double, 3>{high.x, high.y, high.z});
  }
  /// Likewise, of as many boxes at a time as a Real has numbers; corners are given axis by axis.
  template <class Real>
  SpanOf<Real> span_in(std::array<Real, 3> low, std::array<Real, 3> high) const {
    Real farthest{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      low[k] = low[k] - origin_[axis];
      high[k] = high[k] - origin_[axis];
      farthest = larger(farthest, larger(larger(low[k], -low[k]), larger(high[k], -high[k])));
    }
    const Real slack = kSlack * farthest;
    SpanOf<Real> span{Real{} - kFar, Real{} + kFar};
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      narrow(span, axis, low[k] - slack, high[k] + slack);
    }
    return span;
  }

  /// Returns the distance along the ray of the place where it meets a triangle, from either side,
  /// its border included; none if it misses it, or if the place is behind the origin. A triangle
  /// that is seen from its edge, or has no area, is missed.
  std::optional<double> hit(const Vec3f& a, const Vec3f& b, const Vec3f& c) const;

 private:
  static constexpr double kFar = std::numeric_limits<double>::max();
  /// Places of a hit are rounded by some 2^-51 of the distance of corners.
  static constexpr double kSlack = 0x1p-48;
  /// Along an axis that it hardly moves along, a ray stays where it is: quotients stay finite.
  static constexpr double kStill = 1e-250;

  template <class Real>
  static Real larger(Real a, Real b) {
    return a < b ? b : a;
  }
  template <class Real>
  void narrow(SpanOf<Real>& span, int axis, Real from, Real to) const {
    const double pace = inverse_[axis];
    if (pace == 0) {
      const auto is_missed = (from > 0.0) | (to < 0.0);
      span.entry = is_missed ? Real{} + kFar : span.entry;
      span.exit = is_missed ? Real{} - kFar : span.exit;
      return;
    }
    const Real exit = (pace > 0 ? to : from) * pace;
    span.entry = larger(span.entry, (pace > 0 ? from : to) * pace);
    span.exit = exit < span.exit ? exit : span.exit;
  }
  Vec3d sheared(const Vec3f& corner) const;

  Vec3d origin_, direction_;
  Vec3d inverse_;            ///< of the direction; 0 where it stands still
  std::array<int, 3> axes_;  ///< the last one is that of the direction's largest part
  Vec3d shear_;              ///< makes the ray the last axis, with its distances
};

}  // namespace meshhier
