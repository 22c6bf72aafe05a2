// Points spread evenly over the surface that a cut shows.
#pragma once

#include "compare/cut_surface.h"
#include "hierarchy/vec.h"

#include <cstdint>
#include <vector>

namespace meshhier::comparing {

/// Sample numbers [begin, end).
struct SampleRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::uint64_t size() const { return end - begin; }
};

struct SurfaceSample {
  Vec3d point;                 ///< relative to the origin
  std::uint32_t triangle = 0;  ///< of TileSurface::triangles
};

/// Area-uniform samples in strata (Cignoni, Rocchini & Scopigno 1998 sample faces one by one; this
/// has the same density with less noise): with the triangles laid out in order, sample k of N falls
/// where (k + u) / N of the whole area lies, u and the place within the triangle from a hash of k
/// and `stream`. So a triangle with the share a of the area has N a samples, give or take fewer
/// than two. Deterministic; thread-safe.
class SurfaceSampler {
 public:
  /// `surface` must outlive it. Without any area there are no samples.
  SurfaceSampler(const CutSurface& surface, std::uint64_t count, std::uint64_t stream);

  std::uint64_t count() const { return count_; }

  /// The samples on a tile.
  SampleRange on_tile(std::size_t position) const;

  /// Those of `range`, ascending. Requires: part of on_tile(position), which `tile` was loaded for.
  std::vector<SurfaceSample> draw(std::size_t position, const TileSurface& tile,
                                  SampleRange range) const;

 private:
  double target(std::uint64_t sample) const;
  std::uint64_t first_from(double area) const;

  std::vector<double> areas_;  ///< before each tile; then the whole area
  std::size_t last_ = 0;       ///< the last tile with any area
  std::uint64_t count_;
  std::uint64_t stream_;
};

/// The order of points along a Z curve through their box: neighbours in it are near each other.
/// Deterministic.
std::vector<std::uint32_t> curve_order(const std::vector<Vec3d>& points);

}  // namespace meshhier::comparing
