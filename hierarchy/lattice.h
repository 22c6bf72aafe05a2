// The lattice that all positions of a hierarchy lie on if it is quantized: one for all levels, so
// that a vertex has the same place in every tile that shows it.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <cstdint>
#include <span>

namespace meshhier {

/// Points `corner + step * number`, each number from 0 to 2^bits - 1 on each axis. Step is a power
/// of two and corner a multiple of it, at most 2^24 steps from 0 like every point: each point is a
/// float, whatever the order of the arithmetic.
struct Lattice {
  int bits = 0;     ///< kFewestBits to kMostBits
  double step = 1;  ///< input units
  Vec3d corner;     ///< relative to the hierarchy's origin

  static constexpr int kFewestBits = 8;
  static constexpr int kMostBits = 24;  // what a float holds exactly
  static constexpr int kShortBits = 16;

  /// The numbers of the nearest point; halves go up, what lies outside goes to the edge. Requires
  /// finite coordinates.
  Vec3<std::uint32_t> numbers_of(Vec3f position) const;
  /// Its inverse on lattice points.
  Vec3f point(Vec3<std::uint32_t> numbers) const;
  Vec3f nearest(Vec3f position) const { return point(numbers_of(position)); }
  /// Whether the numbers take 16 bits.
  bool is_short() const { return bits <= kShortBits; }
  /// Whether it is what this struct says. O(1); for lattices from outside.
  bool is_sound() const;

  friend bool operator==(const Lattice&, const Lattice&) = default;
};

/// The finest lattice of so many bits that holds all of `bounds`, which lie in its middle. Requires
/// kFewestBits <= bits <= kMostBits and bounds that are not empty. Deterministic.
Lattice make_lattice(const Bounds& bounds, int bits);

/// Moves all positions to their nearest points; returns the largest distance that one went.
double round_to(const Lattice& lattice, std::span<Vec3f> positions);

/// The least float that is not below `value`.
float float_above(double value);

}  // namespace meshhier
