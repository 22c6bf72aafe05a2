#include "render/directions.h"

#include "base/angle.h"

#include <cmath>

namespace meshhier::render {

std::vector<View> views_around(std::uint32_t count, Vec3d up) {
  /// As a part of a full turn: 1 - 1 / golden ratio.
  constexpr double kGoldenTurn = 0.38196601125010515;
  constexpr double kFullTurn = 6.283185307179586;
  std::vector<View> views;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count;
    const double radius = std::sqrt(1 - z * z);
    const double turns = i * kGoldenTurn;
    const UnitTurn turn = turn_by((turns - std::floor(turns)) * kFullTurn);
    views.push_back({Vec3d{radius * turn.cosine, radius * turn.sine, z} * -1, up});
  }
  return views;
}

}  // namespace meshhier::render
