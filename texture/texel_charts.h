// Charts of a partition: connected triangles in the texels of one material.
#pragma once

#include "texture/leaf_atlas.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Coordinates beyond are taken for it: floats as large have no fraction, so there is nothing to
/// see out there but one texel.
inline constexpr double kFarthestTexcoord = 1 << 23;

/// Part of a picture in its coordinates.
struct TexcoordBox {
  double u0, v0, u1, v1;
};

/// A piece of a chart, with the triangles triangles[begin, end) of its ChartPieces.
struct ChartPiece {
  std::uint32_t material = 0;
  std::uint32_t begin = 0, end = 0;
  TexcoordBox box{};  ///< as its triangles have it
};

struct ChartPieces {
  std::vector<std::uint32_t> triangles;
  std::vector<ChartPiece> pieces;
};

/// Texels of a level of a picture, the gutter and what fills them up to the alignment included.
struct TexelBox {
  std::int64_t x = 0, y = 0;
  std::int64_t width = 0, height = 0;
  double area() const { return static_cast<double>(width) * static_cast<double>(height); }
};

/// Width or height of a level. Its texels are 1 / of it in texture coordinates, so that pictures
/// repeat without a seam at each level.
std::uint32_t level_side(std::uint32_t side, std::uint32_t level);

/// The texels for triangles in `box`. O(1).
TexelBox texels_around(const TexcoordBox& box, const AtlasMaterial& material, std::uint32_t level);

double clamped_texcoord(float value);

/// After how many pictures a picture repeats: 1, mirrored 2; 0 if it never does.
double period(const AtlasMaterial& material, Wrap wrap);

/// Triangles that share a vertex, or a material's coordinates to the bit, are one chart. A chart is
/// cut in two by its triangles' middles as long as it is larger than `most_side`, its picture
/// repeats in it, or little of it is covered and the cut saves a fourth of its texels. Equal
/// triangles stay together. O(t log t), times at most twice the bits of a texel's number for cuts.
ChartPieces cut_charts(const LeafTriangles& leaf, std::span<const AtlasMaterial> materials,
                       std::uint32_t most_side);

}  // namespace meshhier::texture
