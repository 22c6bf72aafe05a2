// An exact, total order of vertices along a direction, and a place in it.
#pragma once

#include "base/vec.h"

#include <bit>
#include <compare>
#include <cstdint>
#include <limits>

namespace meshhier::partition {

/// A vertex's place along a direction: the order-preserving bits of its projection; ties broken by
/// vertex id.
struct SplitKey {
  std::uint64_t projection = 0;
  std::uint32_t id = 0;
  friend constexpr auto operator<=>(const SplitKey&, const SplitKey&) = default;

  static constexpr SplitKey lowest() { return {}; }
  static constexpr SplitKey highest() {
    return {std::numeric_limits<std::uint64_t>::max(), std::numeric_limits<std::uint32_t>::max()};
  }
};

/// Maps finite doubles to integers of the same order; -0 and 0 are equal.
constexpr std::uint64_t ordered_bits(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

inline SplitKey key_along(Vec3d direction, Vec3f position, std::uint32_t id) {
  return {ordered_bits(dot(direction, to_double(position))), id};
}

/// Vertices below `first_right` go left, the others right.
struct SplitPlane {
  Vec3d direction;
  SplitKey first_right;
  bool is_right(Vec3f position, std::uint32_t id) const {
    return key_along(direction, position, id) >= first_right;
  }
};

/// A vertex position with its id.
struct IdPoint {
  Vec3f position;
  std::uint32_t id = 0;
};

}  // namespace meshhier::partition
