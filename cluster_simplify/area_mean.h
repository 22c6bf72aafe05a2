// Means of squared distances over area, beside those over vertices.
//
// A mean over vertices counts what scans are made of. It is blind where few vertices span most of
// the surface, as the tip of one long spike does, and where all vertices stay on the surface and
// the triangles between them do not.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <array>
#include <cstdint>
#include <span>

namespace meshhier::cluster_simplify {

/// A mean that is only of interest if it is large: what is near counts as no distance at all, and
/// of its area one triangle in 32 is measured, for all. So scans, where next to nothing is far,
/// cost next to nothing.
class AreaMean {
 public:
  /// One triangle's part in the mean.
  struct Patch {
    double doubled_area = 0;
    double square = 0;  ///< of the distance; may be infinite
  };

  /// `near`: no farther is near.
  explicit AreaMean(double near) : near_(near) {}

  /// `measure()`: the triangle's Patch, asked for if need be.
  template <class Measure>
  void add(double farthest, const Measure& measure) {
    if (farthest > near_) {
      add_far(measure());
    } else if (near_count_++ % kStride == 0) {
      whole_ += kStride * measure().doubled_area;
    }
  }
  double value() const { return whole_ > 0 ? sum_ / whole_ : 0; }

 private:
  static constexpr std::uint32_t kStride = 32;

  void add_far(Patch patch);

  double near_;
  double whole_ = 0;
  double sum_ = 0;
  std::uint32_t near_count_ = 0;
};

/// A triangle that is drawn no more.
struct LostArea {
  double doubled = 0;
  double farthest = 0;  ///< from what is drawn
};

/// Over the surface of a joined tile. `moved`: how far each vertex is from the contracted surface;
/// `over_vertices`: the mean of their squares, of which no small multiple is of interest. O(n).
double mean_over_joined(const TileMesh& joined, std::span<const double> moved,
                        std::span<const LostArea> lost, double over_vertices);

/// Over the surface that is drawn now, from how far its triangles are at most.
class DrawnMean {
 public:
  /// `over_vertices`: the mean of the squares of vertices; nothing below it is of interest.
  /// `careless`: the share of vertices that went by tearing the surface or without care for it.
  explicit DrawnMean(double over_vertices, double careless = 0);

  /// `corners()`: those of the triangle, asked for if need be.
  template <class Corners>
  void add(double farthest, const Corners& corners) {
    const double typical = typical_ * farthest;
    mean_.add(typical, [&] { return patch(corners(), typical); });
  }
  double value() const { return mean_.value(); }

 private:
  static AreaMean::Patch patch(const std::array<Vec3f, 3>& corners, double distance);

  AreaMean mean_;
  double typical_;  ///< part of a certain distance, which is a sum of largest ones
};

}  // namespace meshhier::cluster_simplify
