// The picture of a simplified tile: new charts, texels from the surface that the tile was made of.
//
// Charts are grown by normal (Sander et al. 2001 merge faces so), cut where they fill little of
// their rectangles, projected to a plane, freed of triangles that cover others, and packed. Each
// texel takes its colour from the nearest point of the finer surface that faces alike, as a mean
// over the texel's size in linear light, then from all means those texels are made that look like
// the finer surface once they are filtered.
#pragma once

#include "base/vec.h"
#include "hierarchy/texture.h"
#include "hierarchy/tile_mesh.h"
#include "images/image.h"
#include "texture/corners.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// A tile with its picture. `corners` of its triangles; each triangle has texels of its own chart
/// around it, as far as the charts' alignment says.
struct TexturedSurface {
  std::span<const Vec3f> positions;
  std::span<const TileTriangle> triangles;  ///< numbers of positions
  std::span<const CornerTexcoords> corners;
  const images::Image* image = nullptr;  ///< null: the surface has no triangles
  /// Each vertex of a finer surface has here a vertex of the tile near it, or kNoVertex
  /// (vertex_feet.h). Without them each texel is searched for.
  std::span<const std::uint32_t> beside{};
};

struct BakeSize {
  std::uint32_t side = 512;  ///< of the picture, texels; a multiple of kBakeAlignment, 64 ... 4096
  float least_texel = 0;     ///< no smaller texels than these are made: the finer ones' size
};

inline constexpr std::uint32_t kBakeGutter = 2;
inline constexpr std::uint32_t kBakeAlignment = 4;

struct BakedTexture {
  images::Image image;                   ///< 3 channels, 4 if one of the finer ones has
  std::vector<CornerTexcoords> corners;  ///< one a triangle
  float texel = 0;                       ///< size of a texel on the surface
  /// The size of pixels that differ from the finer surfaces' by 32 decibels, about, as far as the
  /// difference halves with twice the size; larger than a texel where there is much to see.
  float lost = 0;
  std::uint32_t charts = 0;
};

/// The picture with 1 / factor of its width and height (multiples of it), for bake() on the next
/// level: means in linear light of those texels that triangles show, so that charts do not mix.
/// Requires charts aligned to `factor`, a power of two. Pure, single-threaded.
images::Image reduced(const images::Image& image, std::span<const CornerTexcoords> corners,
                      std::uint32_t factor);

/// Returns the mean size of a texel on the surface, in units of its positions: sqrt(area / texels
/// that the triangles cover); 0 if there is no area in either. Pure.
float texel_size(const TexturedSurface& surface, std::uint32_t width, std::uint32_t height);

}  // namespace meshhier::texture
