// Seeded fractal noise, equal bit for bit on every machine: integer hashes and polynomials only.
#pragma once

#include "base/vec.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::bench {

/// Mixes 64 bits so that every input bit reaches every output bit (the finalizer of SplitMix64:
/// Steele, Lea & Flood, Fast Splittable Pseudorandom Number Generators, 2014).
constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The item-th value of the random sequence that `seed` names.
constexpr std::uint64_t random_at(std::uint64_t seed, std::uint64_t item) {
  return mix(mix(seed + 0x9e3779b97f4a7c15u) + item * 0x9e3779b97f4a7c15u);
}

/// A number in [-1, 1) from the upper 53 bits of a hash; exact.
constexpr double signed_unit(std::uint64_t hash) {
  return static_cast<double>(hash >> 11) * 0x1p-52 - 1.0;
}

/// The item-th number in [0, 1) of the random sequence that `seed` names.
constexpr double uniform_at(std::uint64_t seed, std::uint64_t item) {
  return (signed_unit(random_at(seed, item)) + 1) / 2;
}

struct NoiseSample {
  double value = 0;
  Vec3d gradient;
};

struct FractalOptions {
  std::uint64_t seed = 1;
  double height = 1;     ///< height of the first octave: its values lie in [-height, height]
  double frequency = 1;  ///< cycles per unit in the first octave; doubles with every octave
  double gain = 0.5;     ///< height of an octave relative to the one before
  int octaves = 1;       ///< 0 gives a constant 0
};

/// A sum of octaves of smooth value noise (twice continuously differentiable), every octave turned
/// against the one before so that their lattices do not show. Thread-safe.
class FractalNoise {
 public:
  explicit FractalNoise(const FractalOptions& options);

  /// Returns value and gradient at `p`. Requires |p| * frequency * 2^octaves < 2^53.
  NoiseSample at(Vec3d p) const;

 private:
  struct Octave {
    std::array<Vec3d, 3> axes;  ///< rows of rotation times frequency
    double height = 0;
    std::uint64_t seed = 0;
  };
  std::vector<Octave> octaves_;
};

}  // namespace meshhier::bench
