// Charts that fill their rectangles, and do not cover themselves.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "texture/chart_growing.h"
#include "texture/chart_layout.h"
#include "texture/faces.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

struct PlaneCharts {
  SurfaceCharts charts;
  std::vector<ChartPlane> planes;  ///< one a chart
};

/// A chart is cut in two across as long as that saves a sixth of its texels, or is much of the
/// picture. Then triangles that cover the middle of a texel of another one, or are seen from the
/// side, leave it, and make charts of their own with those that are connected to them and leave as
/// well. Texels are as large as fit into side * side for all, about. Deterministic.
PlaneCharts refined(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles,
                    const Faces& faces, const SurfaceCharts& charts, std::uint32_t side);

}  // namespace meshhier::texture
