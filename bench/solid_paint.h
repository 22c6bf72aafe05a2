// A colour for each point of space, with detail of all sizes, which pictures of generated meshes
// show.
#pragma once

#include "base/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::bench {

/// Sums of plane waves. Each octave has half the wave length of the one before, and a little less
/// height: down to the finest, each level of detail shows something that the one below does not. A
/// pure function, equal bit for bit on every machine. Immutable, thread-safe.
class SolidPaint {
 public:
  struct Options {
    std::uint64_t seed = 1;
    double finest_wave = 0.01;  ///< > 0; no wave is shorter
  };
  explicit SolidPaint(const Options& options);

  /// Paints red, green and blue of each point, 3 bytes each, sRGB. Requires points in [-4, 4]^3 and
  /// colours of 3 * points.size().
  void paint(std::span<const Vec3d> points, std::span<std::uint8_t> colours) const;

 private:
  struct Wave {
    Vec3d direction;  ///< times cycles a unit
    double phase = 0;
    std::array<float, 3> height{};  ///< heights in red, green and blue, in steps of 0 to 255
  };

  std::vector<Wave> waves_;
};

}  // namespace meshhier::bench
