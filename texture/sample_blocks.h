// The nearest triangles of finer surfaces, and the texels of a chart in an order in which they are
// found quickly.
#pragma once

#include "base/bounds.h"
#include "base/triangle_tree.h"
#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "texture/chart_layout.h"
#include "texture/nearest_triangle.h"
#include "texture/texel_samples.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// How far a surface that faces alike may be, in texels, so that it is taken before a nearer one
/// that does not.
inline constexpr double kFacingReach = 32;

/// The triangles of several surfaces, numbered through. `tile`: the positions around which is
/// asked.
template <class Surface>
NearestTriangle nearest_among(std::span<const Surface> surfaces, std::span<const Vec3f> tile) {
  std::vector<SurfaceTriangle> triangles;
  for (const Surface& surface : surfaces) {
    for (const TileTriangle& t : surface.triangles)
      triangles.push_back({surface.positions[raw(t[0])], surface.positions[raw(t[1])],
                           surface.positions[raw(t[2])]});
  }
  const Bounds box = bounds_of(tile);
  const Vec3d low = to_double(box.min), high = to_double(box.max);
  const double size = length(high - low);
  return {triangles, (low + high) * 0.5, size > 0 ? size : 1};
}

/// Tells `nearest` what it will be asked for next.
inline void look_around(const TexelSamples& samples, const TexelRange& block,
                        NearestTriangle& nearest) {
  BoundsD box;
  for (std::uint32_t y = block.top; y < block.bottom; ++y) {
    for (std::uint32_t x = block.left; x < block.right; ++x) {
      const TexelSample& sample = samples.at(x, y);
      if (sample.triangle != kNoFace)
        box.add(sample.point);
    }
  }
  if (!box.empty())
    nearest.look_around(box);
}

/// Calls visit(x, y, sample) for each texel of a chart that shows something: block by block, as
/// these have much around them in common, and in a block to and fro, each beside the last one.
template <class Visit>
void for_each_sample(const TexelSamples& samples, const ChartPlane& plane, NearestTriangle& nearest,
                     const Visit& visit) {
  constexpr std::uint32_t kBlock = 8;
  for (std::uint32_t top = plane.top; top < plane.bottom; top += kBlock) {
    for (std::uint32_t left = plane.left; left < plane.right; left += kBlock) {
      const TexelRange block{left, top, std::min(left + kBlock, plane.right),
                             std::min(top + kBlock, plane.bottom)};
      look_around(samples, block, nearest);
      for (std::uint32_t y = block.top; y < block.bottom; ++y) {
        for (std::uint32_t i = block.left; i < block.right; ++i) {
          const std::uint32_t x = (y - block.top) % 2 == 0 ? i : block.left + block.right - 1 - i;
          if (samples.at(x, y).triangle != kNoFace)
            visit(x, y, samples.at(x, y));
        }
      }
    }
  }
}

}  // namespace meshhier::texture
