// Where a chart covers itself.
//
// Problem. A chart must not cover a texel twice. To draw all triangles of all charts for that costs
// as much as to draw the picture, and nearly all charts are sound.
//
// Idea. Where all triangles show their front sides, as many of them cover a texel as the chart's
// border winds around it; so only the border is drawn:
//
//          +---------------+              row:   . . + . . . . . - . . .
//         /     border      \                        |           |
//      row . . +1 . . . . . -1 . . .      winding 0  1  . . . 1  0
//         \                 /
//          +---+    +------+              two or more: covered twice
//
// A winding begins at the first texel whose middle is not left of the edge, by the whole numbers
// of RasterTriangle: edges inside a chart would begin and end it at the same texel, to the bit.
//
// Invariant. A texel beyond the range that is found is covered once at most.
//
// Cost. O(triangles + r log r) for r rows of border edges.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "texture/faces.h"
#include "texture/texel_raster.h"
#include "texture/texel_segment.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// For charts of one surface, which outlives it. Not for several threads.
class ChartOverlap {
 public:
  ChartOverlap(std::span<const TileTriangle> triangles, const Faces& faces)
      : triangles_(triangles), faces_(faces), chart_of_(triangles.size()) {}

  /// Returns a range that holds those texels of `all` that several of the triangles cover; `all` if
  /// one shows its back side, or the border is too long. Corners lie at `places`, one a vertex of
  /// the surface.
  TexelRange operator()(std::span<const std::uint32_t> chart,
                        std::span<const FixedTexelPoint> places, const TexelRange& all);

 private:
  void add_crossings(const FixedTexelPoint& from, const FixedTexelPoint& to, const TexelRange& all);
  TexelRange twice_wound();

  std::span<const TileTriangle> triangles_;
  const Faces& faces_;
  std::vector<std::uint32_t> chart_of_;  ///< the last one asked for that has the triangle
  std::uint32_t chart_ = 0;
  /// Each is a border edge that crosses a row: 32 bits hold the row, 31 the first texel not left of
  /// the edge, 1 whether the chart begins there (1) or ends (0).
  std::vector<std::uint64_t> crossings_;
};

}  // namespace meshhier::texture
