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
// A few tiles are searched at a time, in parallel; distances found in one batch prune the next one.
//
// Invariant. Batches have fixed sizes (kSearchedPoints, kSearchedTiles): results do not depend on
// threads or on the cache, to the bit.
//
// Cost. O(log n) a point and tile; most points are looked up in one tile.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "compare/cut_surface.h"
#include "compare/triangle_search.h"
#include "execution/cancel.h"
#include "execution/parallel.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::comparing {

/// The number of points that share a list of candidate tiles, and a chain of hints. Results must
/// not depend on threads or budget, so neither may this.
inline constexpr std::size_t kSearchedPoints = 256;
/// The number of tiles that are searched at the same time: their trees are held beside the cache's,
/// 40 MiB with 32,768 vertices a tile. It is fixed, as distances found in one batch prune the next
/// one.
inline constexpr std::size_t kSearchedTiles = 8;

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

/// Keeps trees of a surface's tiles; the least recently used go first. For one thread.
class TreeCache {
 public:
  TreeCache(const CutSurface& surface, std::uint64_t limit_bytes)
      : surface_(surface), limit_bytes_(limit_bytes), was_read_(surface.size()) {}

  /// Returns the trees of some tiles, built in parallel as far as they are not there. Requires
  /// positions without repeats. Throws as CutSurface::load().
  std::vector<std::shared_ptr<const TriangleSearch>> get(std::span<const std::uint32_t> positions);
  /// Returns how many different tiles were asked for.
  std::uint64_t tiles_read() const {
    return static_cast<std::uint64_t>(std::ranges::count(was_read_, true));
  }

 private:
  struct Entry {
    std::uint32_t position = 0;
    std::shared_ptr<const TriangleSearch> tree;
  };

  void insert(std::uint32_t position, std::shared_ptr<const TriangleSearch> tree);

  const CutSurface& surface_;
  std::uint64_t limit_bytes_;
  std::uint64_t used_bytes_ = 0;
  std::vector<bool> was_read_;
  std::list<Entry> entries_;  ///< most recently used first
  std::map<std::uint32_t, std::list<Entry>::iterator> places_;
};

/// The triangle of a surface that is nearest to a point.
struct NearestOnSurface {
  double squared = std::numeric_limits<double>::infinity();  ///< the distance's square; infinite if
                                                             ///< there is no triangle
  std::uint32_t tile = 0;                                    ///< position in the cut
  std::uint32_t triangle = 0;                                ///< index in TileSurface::triangles
};

/// A point to be looked up in a tile.
struct TileQuery {
  std::uint32_t tile = 0;
  std::uint32_t point = 0;
};

/// Returns queries in the order of their tiles; those of a tile as they come. O(n + tiles).
std::vector<TileQuery> by_tile(std::span<const TileQuery> queries, std::size_t tiles);

/// Calls look(tree, number of the query, query) for each, in parallel, those of a few tiles at a
/// time.
template <class Look>
void look_up(TreeCache& trees, std::span<const TileQuery> queries,
             const execution::CancelToken& cancel, const Look& look) {
  std::size_t before = 0;
  while (!queries.empty()) {
    cancel.check();
    std::vector<std::uint32_t> tiles;
    std::size_t taken = 0;
    for (; taken < queries.size(); ++taken) {
      if (!tiles.empty() && tiles.back() == queries[taken].tile)
        continue;
      if (tiles.size() == kSearchedTiles)
        break;
      tiles.push_back(queries[taken].tile);
    }
    const auto held = trees.get(tiles);
    const auto batch = queries.first(taken);
    execution::parallel_for(
        (taken + kSearchedPoints - 1) / kSearchedPoints, [&](std::size_t block) {
          const std::size_t first = block * kSearchedPoints;
          for (std::size_t i = first; i < std::min(first + kSearchedPoints, taken); ++i) {
            const auto tile = std::ranges::lower_bound(tiles, batch[i].tile) - tiles.begin();
            look(*held[static_cast<std::size_t>(tile)], before + i, batch[i]);
          }
        });
    before += taken;
    queries = queries.subspan(taken);
  }
}

/// Measures distances to a surface. One call at a time; it works in parallel.
class SurfaceDistance {
 public:
  /// `cache_bytes`: memory for the trees of tiles; a few are held at a time whatever it is.
  /// `surface` must outlive it.
  SurfaceDistance(const CutSurface& surface, std::uint64_t cache_bytes)
      : surface_(surface), trees_(surface, cache_bytes) {}

  /// Returns the distance of each point, in the order of the points; infinite if the surface has no
  /// triangle. Points that follow each other should be near each other (curve_order()), for speed
  /// only. Holds some 50 bytes a point; parallel; the result depends on the points and the surface
  /// alone, to the bit. Throws Error(io | corrupt) if a tile cannot be read, Error(interrupted).
  std::vector<double> distances(std::span<const Vec3d> points,
                                const execution::CancelToken& cancel);
  /// Returns the nearest triangle of each point, likewise; one of them if several are equally near.
  std::vector<NearestOnSurface> nearest(std::span<const Vec3d> points,
                                        const execution::CancelToken& cancel);

  /// Returns the triangles themselves. Requires that nearest() has found them: squared distances
  /// are finite.
  std::vector<SurfaceTriangle> triangles(std::span<const NearestOnSurface> found,
                                         const execution::CancelToken& cancel);

  TreeCache& trees() { return trees_; }

 private:
  using Query = TileQuery;

  /// The tiles that may hold the nearest triangle of one of a block of points, nearest box first.
  struct Candidate {
    double squared = 0;  ///< distance between the boxes
    std::uint32_t tile = 0;
    friend auto operator<=>(const Candidate&, const Candidate&) = default;
  };

  std::vector<Candidate> candidates(std::span<const Vec3d> block) const;
  std::uint32_t likely_tile(Vec3d point, std::span<const Candidate> candidates) const;
  std::vector<Query> take_batch(std::span<const Vec3d> points,
                                std::span<const NearestOnSurface> found,
                                std::span<const Query>& queries) const;
  std::vector<NearestOnSurface> answer_batch(std::span<const Vec3d> points,
                                             std::span<const NearestOnSurface> found,
                                             std::span<const Query> batch);
  void answer(std::span<const Vec3d> points, std::span<const Query> queries,
              std::vector<NearestOnSurface>& found, const execution::CancelToken& cancel);

  const CutSurface& surface_;
  TreeCache trees_;
};

}  // namespace meshhier::comparing
