// The exact distance of points to the surface that a cut shows, without holding all of it.
#pragma once

#include "compare/cut_surface.h"
#include "compare/triangle_search.h"
#include "execution/cancel.h"
#include "execution/parallel.h"
#include "hierarchy/bounds.h"
#include "hierarchy/vec.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::comparing {

/// Points that share a list of candidate tiles, and a chain of hints. Results must not depend on
/// threads or budget, so neither may this.
inline constexpr std::size_t kSearchedPoints = 256;
/// Tiles searched at the same time: their trees are held beside the cache's. With 32,768 vertices a
/// tile, 60 MiB. Fixed, as what is found in one batch prunes the next.
inline constexpr std::size_t kSearchedTiles = 8;

/// Square of the distance between two boxes, neither of them empty; 0 if they meet.
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
/// Square of the distance of a point to a box; 0 inside. `bounds` must not be empty.
double squared_distance(Vec3d point, const Bounds& bounds);

/// Trees of a surface's tiles; the least recently used go first.
class TreeCache {
 public:
  TreeCache(const CutSurface& surface, std::uint64_t limit_bytes)
      : surface_(surface), limit_bytes_(limit_bytes), was_read_(surface.size()) {}

  /// The trees of some tiles, built in parallel as far as they are not there. Positions without
  /// repeats.
  std::vector<std::shared_ptr<const TriangleSearch>> get(std::span<const std::uint32_t> positions);
  /// How many different ones were asked for.
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

/// Where a surface is nearest to a point.
struct NearestTriangle {
  double squared = std::numeric_limits<double>::infinity();  ///< distance; if there is no triangle
  std::uint32_t tile = 0;                                    ///< position in the cut
  std::uint32_t triangle = 0;                                ///< of TileSurface::triangles
};

/// A point to be looked up in a tile.
struct TileQuery {
  std::uint32_t tile = 0;
  std::uint32_t point = 0;
};

/// Queries in the order of their tiles; those of a tile as they come. O(n + tiles).
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

class SurfaceDistance {
 public:
  /// `cache_bytes`: for the trees of tiles; a few are held at a time whatever it is. `surface` must
  /// outlive it.
  SurfaceDistance(const CutSurface& surface, std::uint64_t cache_bytes)
      : surface_(surface), trees_(surface, cache_bytes) {}

  /// The distance of each point, in the order of the points: infinite if the surface has no
  /// triangle. Points that follow each other should be near each other (curve_order()), for speed
  /// only. Holds some 50 bytes a point; parallel; the result depends on the points and the surface
  /// alone, to the bit. Throws Error(io | corrupt) if a tile cannot be read, Error(interrupted).
  std::vector<double> distances(std::span<const Vec3d> points,
                                const execution::CancelToken& cancel);
  /// Likewise; of several triangles that are equally near one.
  std::vector<NearestTriangle> nearest(std::span<const Vec3d> points,
                                       const execution::CancelToken& cancel);

  /// The triangles themselves. Requires that nearest() has found them: squared distances are
  /// finite.
  std::vector<SurfaceTriangle> triangles(std::span<const NearestTriangle> found,
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
                                std::span<const NearestTriangle> found,
                                std::span<const Query>& queries) const;
  std::vector<NearestTriangle> answer_batch(std::span<const Vec3d> points,
                                            std::span<const NearestTriangle> found,
                                            std::span<const Query> batch);
  void answer(std::span<const Vec3d> points, std::span<const Query> queries,
              std::vector<NearestTriangle>& found, const execution::CancelToken& cancel);

  const CutSurface& surface_;
  TreeCache trees_;
};

}  // namespace meshhier::comparing
