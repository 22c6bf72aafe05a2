// Points that are spread evenly over the surface of a cut.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "compare/cut_surface.h"

#include <cstdint>
#include <vector>

namespace meshhier::comparing {

/// A range of samples' numbers, [begin, end).
struct SampleRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::uint64_t size() const { return end - begin; }
};

struct SurfaceSample {
  Vec3d point;                 ///< relative to the origin
  std::uint32_t triangle = 0;  ///< index in TileSurface::triangles
};

/// Takes area-uniform samples in strata (Cignoni, Rocchini & Scopigno 1998 sample faces one by one;
/// this has the same density with less noise). The triangles are laid out in order along a line, as
/// long as their areas; sample k of N falls into the k-th of N equal parts of it:
///
///      triangles   |   t0   |t1|      t2       | t3 |
///      parts       | 0  | 1  | 2  | 3  | 4  | 5  | 6|
///      samples       *    *   *      *    *   *    *     sample k at (k + u) / N of the area
///
/// u, and the place within the triangle, come from a hash of k and `stream`. So a triangle with the
/// share a of the area has N a samples, give or take fewer than two. A tile knows its samples from
/// the area before it alone: tiles can be drawn in any order. Deterministic; thread-safe.
class SurfaceSampler {
 public:
  /// `surface` must outlive it. Without any area there are no samples. O(tiles).
  SurfaceSampler(const CutSurface& surface, std::uint64_t count, std::uint64_t stream);

  std::uint64_t count() const { return count_; }

  /// Returns the samples on a tile. O(log count).
  SampleRange on_tile(std::size_t position) const;

  /// Draws the samples of `range`, ascending by number. Requires that `range` is part of
  /// on_tile(position), and `tile` the one at that position. O(triangles + samples).
  std::vector<SurfaceSample> draw(std::size_t position, const TileSurface& tile,
                                  SampleRange range) const;

 private:
  double target(std::uint64_t sample) const;
  std::uint64_t first_from(double area) const;

  std::vector<double> areas_;  ///< area before each tile; then the whole area
  std::size_t last_ = 0;       ///< the last tile with any area
  std::uint64_t count_;
  std::uint64_t stream_;
};

/// A Z curve through a cube.
class ZCurve {
 public:
  /// `box`: in the cube, at its least corner.
  explicit ZCurve(const BoundsD& box);
  /// Returns how far along the curve the cell of a point is, one of 2^63; beyond the cube, that of
  /// the nearest cell. Requires finite coordinates.
  std::uint64_t place_of(Vec3d point) const;

 private:
  Vec3d corner_;
  double side_;
};

/// Returns the order of points along a Z curve through their box: neighbours in it are near each
/// other. O(n log n). Deterministic.
std::vector<std::uint32_t> curve_order(const std::vector<Vec3d>& points);

}  // namespace meshhier::comparing
