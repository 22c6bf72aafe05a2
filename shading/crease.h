// Where a surface is smooth, and where it has an edge.
#pragma once

#include "hierarchy/angle.h"

#include <numbers>

namespace meshhier::shading {

/// Degrees, 0 to 180: surfaces that meet at more have a normal each.
inline constexpr double kCreaseAngle = 60;

/// The cosine of a part of it.
inline double crease_cosine(double part = 1) {
  return turn_by(part * kCreaseAngle * std::numbers::pi / 180).cosine;
}

}  // namespace meshhier::shading
