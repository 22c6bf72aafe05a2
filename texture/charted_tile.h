// A coarse tile cut into charts: its picture and its normal map are baked on the same ones, so that
// both have the same texels and vertices are split once for both.
#pragma once

#include "texture/bake.h"
#include "texture/distinct_triangles.h"
#include "texture/finer_points.h"
#include "texture/normal_bake.h"
#include "texture/texel_samples.h"

#include <span>
#include <utility>
#include <vector>

namespace meshhier::texture {

/// The charts of a tile, laid out for a picture of that size, and what their texels show.
struct ChartedTile {
  /// `tile` has a triangle; its `corners` and `image` are unused. `shapes`: what it was made of and
  /// what lies around it. O(t log t + texels).
  ChartedTile(const TexturedSurface& tile, const BakeSize& size, std::vector<FinerShape> shapes)
      : distinct(tile.triangles),
        surface{tile.positions, distinct.triangles(), {}, nullptr},
        samples(surface, size),
        finer(std::move(shapes), samples),
        points(finer.points(samples)) {}
  ChartedTile(const ChartedTile&) = delete;
  ChartedTile& operator=(const ChartedTile&) = delete;

  const DistinctTriangles distinct;
  const TexturedSurface surface;  ///< with each triangle once
  const TexelSamples samples;
  const FinerSurfaces finer;
  const std::vector<FinerPoint> points;  ///< of texels
};

/// Makes the picture. `finer`: of the shapes, in their order, of which of equally near points that
/// of the first counts. No texel is empty: those between charts have colours of the nearest chart;
/// all are black if no finer surface has triangles. Equal triangles get equal corners. Pure,
/// deterministic, single-threaded: call it for several tiles at once. O(texels).
BakedTexture bake(const ChartedTile& tile, std::span<const TexturedSurface> finer);

/// Makes the normal map on the picture's texels. `normals`: at the tile's corners, one entry a
/// triangle. `finer`: of the shapes, in their order, as NormalBaker has it. The map's corners are
/// rounded; the picture's do. Pure, deterministic, single-threaded.
BakedNormalMap bake_normal_map(const ChartedTile& tile, std::span<const CornerNormals> normals,
                               std::span<const NormalSurface> finer);

}  // namespace meshhier::texture
