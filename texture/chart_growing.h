// Pieces of a surface that are nearly flat.
#pragma once

#include "texture/faces.h"

#include <cstdint>
#include <vector>

namespace meshhier::texture {

/// Triangles, chart by chart.
struct SurfaceCharts {
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> ends;  ///< of each chart, in `triangles`

  std::uint32_t begin_of(std::size_t chart) const { return chart == 0 ? 0 : ends[chart - 1]; }
};

/// Grows charts over edges from the first triangle that has none, breadth first, as long as
/// triangles face as their chart does. What counts is the normal of a triangle's surroundings, so
/// that noise does not make charts of single triangles; the triangle itself must only not be seen
/// too much from the side. Then small charts join neighbours that face alike. Deterministic,
/// O(t log t).
SurfaceCharts grow_charts(const Faces& faces);

}  // namespace meshhier::texture
