// Where a surface is smooth, and where it has an edge.
#pragma once

#include "base/angle.h"

#include <numbers>

namespace meshhier::shading {

/// Degrees, 0 to 180: surfaces that meet at more have a normal each.
inline constexpr double kCreaseAngle = 60;

/// The cosine of a part of it.
inline double crease_cosine(double part) {
  return turn_by(part * kCreaseAngle * std::numbers::pi / 180).cosine;
}
/// Its cosine, which many places ask for.
inline double crease_cosine() {
  static const double cosine = crease_cosine(1);
  return cosine;
}

}  // namespace meshhier::shading
