// The places of a grid of patches in the pictures of a textured mesh: each patch is cut into
// charts, squares of its cells, and these are scattered over all pictures, as photogrammetry does
// it.
#pragma once

#include "bench/patch_grid.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::bench {

struct AtlasOptions {
  std::uint32_t images = 1;    ///< [1, 10000]
  std::uint32_t side = 2048;   ///< side of a picture, texels, [64, 65500]
  std::uint32_t charts = 256;  ///< charts of a picture, about; [1, 65536]
  std::uint32_t gutter = 4;    ///< around a chart, texels with the colour of its border; [0, 64]
  std::uint64_t seed = 1;
};

/// Cells [column_begin, column_end) x [row_begin, row_end) of a patch.
struct ChartCells {
  std::uint32_t patch = 0;
  std::uint32_t column_begin = 0, column_end = 0;
  std::uint32_t row_begin = 0, row_end = 0;

  std::uint32_t columns() const { return column_end - column_begin; }
  std::uint32_t rows() const { return row_end - row_begin; }
};

/// A place in a picture, texels from its upper left corner; or in a chart.
struct TexelPlace {
  double x = 0, y = 0;
};

/// A place in a chart: cells from its lowest column and row.
struct ChartPlace {
  double column = 0, row = 0;
};

/// A chart is a square in its picture, turned by quarters: its columns go right, up, left or down.
struct PlacedChart {
  ChartCells cells;
  std::uint32_t image = 0;
  std::uint32_t x = 0, y = 0;  ///< its square's upper left corner, without the gutter
  std::uint32_t side = 0;      ///< side of its square, texels
  std::uint32_t turns = 0;     ///< counter-clockwise, 0 to 3

  TexelPlace texel_of(ChartPlace place) const;
  /// Does the inverse. Places beyond the square are moved to its border.
  ChartPlace place_of(TexelPlace texel) const;
  /// Returns whether places of a row of texels lie in a row of the chart, else in a column.
  bool rows_stay_rows() const { return turns % 2 == 0; }
};

/// Immutable, thread-safe; O(charts) memory.
class ChartAtlas {
 public:
  /// Throws Error(usage) that names the option that is out of range.
  ChartAtlas(const PatchGrid& grid, const AtlasOptions& options);

  const AtlasOptions& options() const { return options_; }
  std::uint32_t chart_count() const { return static_cast<std::uint32_t>(chart_in_.size()); }
  /// Charts that a picture has in a row, and rows of them.
  std::uint32_t slots_a_row() const { return slots_a_row_; }
  /// Texels from one chart to the next, two gutters with it.
  std::uint32_t slot_side() const { return options_.side / slots_a_row_; }
  std::uint32_t chart_side() const { return slot_side() - 2 * options_.gutter; }
  /// Charts that lie side by side in a patch.
  std::uint32_t charts_a_side() const { return charts_a_side_; }

  /// The chart at (column, row) of the slots of a picture; some pictures have empty ones.
  std::optional<PlacedChart> chart(std::uint32_t image, std::uint32_t column,
                                   std::uint32_t row) const;

 private:
  ChartCells cells_of(std::uint32_t chart) const;

  AtlasOptions options_;
  std::uint32_t cells_;
  std::uint32_t charts_a_side_ = 1;
  std::uint32_t slots_a_row_ = 1;
  std::vector<std::uint32_t> chart_in_;  ///< the chart in each slot, picture by picture, row by row
};

}  // namespace meshhier::bench
