// The triangles of a cut that rays hit first, without holding all of it.
//
// Idea. As for nearest points (surface_distance.h), in two rounds: each ray is looked up in the
// tile whose box it enters first, then in all whose boxes it enters before what it hit there. A
// tree over the boxes of the tiles tells which they are.
//
//      ray  ----[--tile 1--]-----[--tile 2-x]------[--tile 3--]--->
//               1. missed        2. hit            2. not asked: entered behind the hit, if tile 2
//                                                     was asked before it
//
// Invariant. The answer is that of trying all triangles, to the bit (base/ray.h).
//
// Cost. O(log n) a ray and tile. A tile is read twice a call, or more often if most rays enter very
// many; fewer times if the cache holds it.
#pragma once

#include "base/ray.h"
#include "base/triangle_tree.h"
#include "compare/cut_surface.h"
#include "compare/tile_trees.h"
#include "execution/cancel.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::comparing {

/// The place where a ray hits a surface first.
struct HitOnSurface {
  double distance = kBehindAll;  ///< along the ray; kBehindAll: it hits nothing
  std::uint32_t tile = 0;        ///< position in the cut
  std::uint32_t triangle = 0;    ///< index in TileSurface::triangles

  bool is_there() const { return distance < kBehindAll; }
};

/// Follows rays to a surface. One call at a time; it works in parallel.
class SurfaceRays {
 public:
  /// `surface` and `trees`, of its tiles, must outlive it.
  SurfaceRays(const CutSurface& surface, TreeCache& trees);

  /// Returns what each ray hits first, by Ray::hit(); of what is hit at one distance, what the
  /// first tile in the cut has, and of that the first triangle. Rays are relative to the origin.
  /// Those that follow each other should be near each other, for speed only. The result, and the
  /// last call of `take` for a ray that hits, depend on rays and surface alone, to the bit. Throws
  /// as SurfaceDistance.
  std::vector<HitOnSurface> first_hits(std::span<const Ray> rays, const TakeShown& take,
                                       const execution::CancelToken& cancel);

 private:
  std::vector<TileQuery> first_tiles(std::span<const Ray> rays) const;

  const CutSurface& surface_;
  TreeCache& trees_;
  std::vector<std::uint32_t> tiles_;  ///< those that draw anything
  TriangleTree boxes_;                ///< over their boxes
};

}  // namespace meshhier::comparing
