// The windows of a raster, the tiles over each, and how many are drawn at once.
#pragma once

#include "base/bounds.h"
#include "export/map_frame.h"
#include "export/pixel_grid.h"
#include "hierarchy/published.h"
#include "render/plan_raster.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::exporting {

/// What is drawn at once.
struct WindowPlan {
  std::uint32_t side = 0;  ///< of windows, pixels: whole tiles of the file
  std::size_t in_flight = 1;
};

/// Returns the largest windows that keep all threads at work within the memory, but no more than
/// are needed for that. `tile_bytes`: of a tile of the hierarchy at work. Throws Error(budget),
/// which names `budget_bytes` that would do, if not even the smallest one fits.
WindowPlan plan_windows(const PixelGrid& grid, std::uint64_t tile_bytes,
                        std::uint64_t budget_bytes);

/// Returns the memory that a tile takes while it is drawn, about.
std::uint64_t drawn_bytes(const TileRecord& record, std::size_t channels, bool has_colours);

/// A window, and which tiles may draw in it, ascending.
struct PlannedWindow {
  render::PlanWindow window;
  std::vector<std::uint32_t> tiles{};
};

/// Returns all windows row by row. `boxes`: of all that each tile draws, in the hierarchy's
/// positions; empty: nothing. O(windows and tiles over them).
std::vector<PlannedWindow> windows_over(const MapFrame& frame, const PixelGrid& grid,
                                        std::uint32_t side, std::span<const BoundsD> boxes);

}  // namespace meshhier::exporting
