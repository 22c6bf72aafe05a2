// The highest surface at the middle of each pixel, seen straight down.
//
// Problem. An orthophoto and its heights are rasters without end, drawn window by window, by any
// number of threads; and where a vertex lies in the middle of a pixel its very height is meant.
//
// Idea. Corners are snapped to 1/256 of a pixel of the whole raster, whole numbers from there on
// (coverage.h): a window takes off its first pixel, and decides as the whole would. A triangle
// covers all middles within and on its edges; where two meet on an edge both have the same height
// there, and the first one stays.
//
//      +-------+-------+        a, b: corners in the middles of pixels; their heights come out
//      |   a---|---b   |        as they are. On the edge from a to b the triangles on both sides
//      +---|\--+--/|---+        cover the pixels. No pixel between is left open, none on the
//      |   | \ | / |   |        border of the surface is lost.
//      +---|--\|/--|---+
//
// Invariant. A pixel depends on the triangles over it and their order alone. Of equal heights the
// first one drawn stays. What is transparent is not there.
//
// Cost. Linear in the triangles and in the pixels that they cover; 8 bytes a pixel.
#pragma once

#include "base/vec.h"
#include "hierarchy/texture.h"
#include "hierarchy/triangle.h"
#include "render/coverage.h"
#include "render/mip_texture.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::render {

/// The most pixels along a side of a raster, and how far beyond it a corner may lie: products of
/// distances, in steps, stay below 2^61.
inline constexpr std::uint32_t kMostPlanSide = std::uint32_t{1} << 21;
inline constexpr std::uint32_t kMostPlanMargin = std::uint32_t{1} << 20;

/// Triangles over the pixels of a raster.
struct PlanMesh {
  /// Per vertex: columns from the left, rows from the top (pixel (i, j) is [i, i + 1] x [j, j +
  /// 1]), height. What reaches beyond kMostPlanSide is moved there.
  std::vector<Vec3d> places;
  std::vector<Triangle<std::uint32_t>> triangles;  ///< corners are indices of vertices
  std::vector<Vec3f> lights;                       ///< linear light, per vertex; may be empty
  std::vector<Vec2f> texcoords;                    ///< per vertex, if there is a texture
  std::unique_ptr<const MipTexture> texture;       ///< multiplied by the lights, if both are there
};

/// Pixels of a raster.
struct PlanWindow {
  std::uint32_t column = 0, row = 0;    ///< of the first one
  std::uint32_t width = 0, height = 0;  ///< 1 or more
};

/// For one thread.
class PlanRaster {
 public:
  static constexpr float kNothing = -std::numeric_limits<float>::infinity();

  /// `has_colours`: else only heights are drawn.
  PlanRaster(const PlanWindow& window, bool has_colours);

  void draw(const PlanMesh& mesh);

  /// Row by row from the top; kNothing where nothing is.
  std::span<const float> heights() const { return heights_; }
  /// Red, green, blue and alpha, 4 bytes a pixel: 255 where something is, else 0, 0, 0, 0. Empty
  /// without colours.
  std::span<const std::uint8_t> colours() const { return colours_; }

 private:
  GridPoint in_window(Vec3d place) const;
  void draw(const PlanMesh& mesh, const Triangle<std::uint32_t>& triangle,
            const std::array<GridPoint, 3>& corners);

  PlanWindow window_;
  std::vector<float> heights_;
  std::vector<std::uint8_t> colours_;
};

}  // namespace meshhier::render
