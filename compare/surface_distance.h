// The exact distance of points to the surface that a cut shows, without holding all of it.
//
// Problem. Each point needs the tile with the nearest triangle; trees of all tiles do not fit into
// memory, and a tile is slow to load.
//
// Idea. Blocks of points that lie near each other share a list of candidate tiles, those whose
// boxes may hold the nearest triangle of one of them, nearest box first. All points are looked up
// tile by tile, in two rounds:
//
//      1. in the tile whose box is nearest (nearly always the right one):   a distance d
//      2. in the other candidates whose boxes are nearer than d             -> the least
//
//            +-- tile 1 --+        +-- tile 2 --+
//            |        *   |   p    |  *         |     the box of tile 2 is nearer to p than
//            |        <---|---|    |            |     the triangle found in tile 1: look there, too
//            +------------+   |<-->+            |
//                                  +------------+
//
// tile_trees.h tells how tiles are searched; results do not depend on threads or on the cache, to
// the bit.
//
// Cost. O(log n) a point and tile; most points are looked up in one tile.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "compare/cut_surface.h"
#include "compare/tile_trees.h"
#include "compare/triangle_search.h"
#include "execution/cancel.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::comparing {

/// Returns the square of the distance between two boxes, neither of them empty; 0 if they meet.
template <class A, class B>
double squared_gap(const BoundsOf<A>& a, const BoundsOf<B>& b) {
  const auto squared = [](double low, double high) {
    const double gap = std::max({low, 0.0, high});
    return gap * gap;
  };
  return squared(double{b.min.x} - a.max.x, double{a.min.x} - b.max.x) +
         squared(double{b.min.y} - a.max.y, double{a.min.y} - b.max.y) +
         squared(double{b.min.z} - a.max.z, double{a.min.z} - b.max.z);
}
/// Returns the square of the distance of a point to a box; 0 inside. `bounds` must not be empty.
double squared_distance(Vec3d point, const Bounds& bounds);

/// The triangle of a surface that is nearest to a point.
struct NearestOnSurface {
  double squared = std::numeric_limits<double>::infinity();  ///< the distance's square; infinite if
                                                             ///< there is no triangle
  std::uint32_t tile = 0;                                    ///< position in the cut
  std::uint32_t triangle = 0;                                ///< index in TileSurface::triangles
};

/// Which triangle is named where several are equally near.
enum class Ties {
  any,   ///< one of them; quicker for points that lie on the surface
  first  ///< of the first tile in the cut, the first one: whatever points are asked besides
};

/// Measures distances to a surface. One call at a time; it works in parallel.
class SurfaceDistance {
 public:
  /// `cache_bytes`: memory for the trees of tiles; a few are held at a time whatever it is.
  /// `surface` must outlive it.
  SurfaceDistance(const CutSurface& surface, std::uint64_t cache_bytes)
      : surface_(surface),
        trees_(surface, cache_bytes),
        squared_size_(squared_diagonal(surface.total().bounds)) {}

  /// Returns the distance of each point, in the order of the points; infinite if the surface has no
  /// triangle. Points that follow each other should be near each other (curve_order()), for speed
  /// only. Holds some 50 bytes a point; parallel; the result depends on the points and the surface
  /// alone, to the bit. Throws Error(io | corrupt) if a tile cannot be read, Error(interrupted).
  std::vector<double> distances(std::span<const Vec3d> points,
                                const execution::CancelToken& cancel);
  /// Returns the nearest triangle of each point, likewise. What is nearest is decided by
  /// squared_distance(), with its rounding: the answer of Ties::first is that of trying all
  /// triangles of the surface. `take`: if it is there, its last call for a point tells the
  /// triangle.
  std::vector<NearestOnSurface> nearest(std::span<const Vec3d> points,
                                        const execution::CancelToken& cancel, Ties ties = Ties::any,
                                        const TakeShown& take = {});

  TreeCache& trees() { return trees_; }
  /// Returns how many different tiles were read.
  std::uint64_t tiles_read() const { return trees_.tiles_read(); }

 private:
  /// The tiles that may hold the nearest triangle of one of a block of points, nearest box first.
  struct Candidate {
    double squared = 0;  ///< distance between the boxes
    std::uint32_t tile = 0;
    friend auto operator<=>(const Candidate&, const Candidate&) = default;
  };

  std::vector<Candidate> candidates(std::span<const Vec3d> block) const;
  std::uint32_t likely_tile(Vec3d point, std::span<const Candidate> candidates) const;

  const CutSurface& surface_;
  TreeCache trees_;
  double squared_size_;  ///< of the diagonal of the surface's box
};

}  // namespace meshhier::comparing
