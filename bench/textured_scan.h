// A generated surface with charts and pictures, like a textured scan.
#pragma once

#include "bench/chart_atlas.h"
#include "bench/generator.h"
#include "bench/relief_surface.h"
#include "bench/solid_paint.h"

#include <cstdint>
#include <functional>
#include <span>

namespace meshhier::bench {

struct TexturedOptions {
  SurfaceOptions surface;  ///< normals, colours and alpha do not count
  AtlasOptions atlas;
};

/// A pure function of the options. Its pictures show a SolidPaint where the triangles lie that they
/// are on. Immutable, thread-safe; O(sqrt(triangles) + charts) memory.
class TexturedScan {
 public:
  /// Throws Error(usage) as make_surface() and ChartAtlas.
  explicit TexturedScan(const TexturedOptions& options);

  const TexturedOptions& options() const { return options_; }
  const ReliefSurface& surface() const { return surface_; }
  const PatchGrid& grid() const { return surface_.grid(); }
  const ChartAtlas& atlas() const { return atlas_; }
  const SolidPaint& paint() const { return paint_; }

  /// Visits each chart, picture by picture.
  void visit_charts(const std::function<void(const PlacedChart&)>& visit) const;

  /// Rows of a picture from its top, each of 3 * side bytes: red, green, blue.
  void visit_rows(std::uint32_t image,
                  const std::function<void(std::span<const std::uint8_t>)>& visit) const;

 private:
  TexturedOptions options_;
  ReliefSurface surface_;
  ChartAtlas atlas_;
  SolidPaint paint_;
};

/// The point of the grid at a corner of the cells of a chart.
inline PatchPoint grid_point(const PlacedChart& chart, std::uint32_t column, std::uint32_t row) {
  return {chart.cells.patch, chart.cells.column_begin + column, chart.cells.row_begin + row};
}

}  // namespace meshhier::bench
