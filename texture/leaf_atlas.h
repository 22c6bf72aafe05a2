// The picture of a partition: the input's texels, cut out chart by chart.
//
// A chart is a connected piece of the tile in the coordinates of one material. Its rectangle of
// texels, with a gutter around it, is copied as it is: a texel of the atlas is a texel of the
// input. A chart that fills little of its rectangle is cut in two, and so is one in which its
// picture repeats. Charts that show the same texels share them.
#pragma once

#include "hierarchy/texture.h"
#include "hierarchy/tile_mesh.h"
#include "texture/corners.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Texels around each chart's triangles, and what its rectangle's corner and sides are multiples
/// of: a picture of an eighth of the size still has no texel of two charts.
inline constexpr std::uint32_t kLeafGutter = 4;
inline constexpr std::uint32_t kLeafAlignment = 8;

/// A material as the atlas sees it.
struct AtlasMaterial {
  std::uint32_t width = 0, height = 0;  ///< of its picture; 0: a colour alone
  std::uint32_t levels = 1;             ///< of the picture's pyramid
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

/// Vertices have the numbers of VertexNumbers: places, then copies.
struct LeafTriangles {
  std::span<const TileTriangle> triangles;   ///< interior, then border; vertices' numbers
  std::span<const Vec2f> texcoords;          ///< of each vertex, in its material; finite
  std::span<const std::uint32_t> materials;  ///< of each vertex; of a triangle: its first corner's
};

/// A rectangle of the atlas, and what it shows.
struct AtlasPiece {
  std::uint32_t material = 0;
  std::uint32_t level = 0;                 ///< of the picture's pyramid
  std::int64_t x = 0, y = 0;               ///< in that level; beyond the picture wraps count
  std::uint32_t atlas_x = 0, atlas_y = 0;  ///< where it goes
  std::uint32_t width = 0, height = 0;     ///< texels, gutter and all
};

struct LeafAtlas {
  std::uint32_t width = 0, height = 0;  ///< multiples of kLeafAlignment; 0: no triangles
  std::vector<AtlasPiece> pieces;
  std::vector<CornerTexcoords> corners;  ///< of all triangles, in the atlas
  std::uint64_t charts = 0;
  std::uint64_t reduced = 0;  ///< triangles shown by a coarser level of their picture
};

/// Plans the picture of a partition. Pure, deterministic, single-threaded: call it for several
/// tiles at once. Charts that are larger than the atlas may be, such as those of a picture that
/// repeats many times over few triangles, are cut, then shown by a coarser level; so is the largest
/// of the charts, level by level, until all fit into most_side * most_side. Triangles of equal
/// vertices get equal corners. Requires materials in range and triangles' corners below the vertex
/// count; coordinates of any size: those beyond 2^23 are taken for it. Only if 8 x 8 texels a
/// material have no room in most_side * most_side, the atlas is larger. A level of a picture is 0
/// ... 1 wide, however its sides were rounded. O(t log t), a few times over.
LeafAtlas plan_leaf_atlas(const LeafTriangles& leaf, std::span<const AtlasMaterial> materials,
                          std::uint32_t most_side);

}  // namespace meshhier::texture
