// Charts of a surface laid out in a picture: packed at one density.
#pragma once

#include "base/vec.h"
#include "texture/bake.h"
#include "texture/texel_raster.h"

#include <cstdint>
#include <vector>

namespace meshhier::texture {

/// Where a chart lies: a point's texel is `corner` + density * (along x - low_x, along y - low_y).
struct ChartPlane {
  Vec3d x, y, normal;  ///< of length 1, at right angles
  double low_x = 0, low_y = 0;
  double width = 0, height = 0;  ///< of the chart, in units of the surface
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;  ///< its rectangle of texels
  bool is_point = false;  ///< no room: all its triangles show one colour
};

struct ChartLayout {
  std::uint32_t width = 0, height = 0;  ///< texels
  double density = 1;                   ///< texels a unit of the surface
  std::vector<ChartPlane> planes;       ///< one a chart

  TexelPoint texel_of(const ChartPlane& plane, const Vec3d& position) const;
};

/// The highest density at which all charts fit into side * side, within a hundredth; none that
/// makes texels smaller than `size.least_texel`. If there are too many charts, the smallest are
/// points. Deterministic.
ChartLayout lay_out(std::vector<ChartPlane> planes, const BakeSize& size);

}  // namespace meshhier::texture
