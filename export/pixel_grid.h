// The pixels of a raster on a map.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "export/plan_region.h"

#include <cstdint>

namespace meshhier::exporting {

/// North is up: rows go down from the top.
struct PixelGrid {
  double left = 0, top = 0;  ///< corner of the first pixel
  double size = 1;           ///< a pixel's side
  std::uint32_t width = 0, height = 0;

  /// Returns columns from the left, rows from the top, and the height as it is.
  Vec3d on_grid(Vec3d map) const { return {(map.x - left) / size, (top - map.y) / size, map.z}; }
};

/// Returns the pixels that a box touches, but for the 512th part of a pixel, which is rounding.
/// `corner`: a corner of pixels, in the box or not. Requires size > 0. Throws Error(usage), which
/// names a size that would do, if a side has more than render::kMostPlanSide pixels.
PixelGrid grid_over(const BoundsD& box, double size, PlanPoint corner);

}  // namespace meshhier::exporting
