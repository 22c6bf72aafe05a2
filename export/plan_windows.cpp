#include "export/plan_windows.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "execution/size_text.h"
#include "images/tiff_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

using images::kTiffTileSide;

/// The largest window: 8192 pixels.
constexpr std::uint32_t kMostTilesASide = 16;

/// A window's colours and heights, and a tile of the file that is packed.
std::uint64_t window_bytes(std::uint32_t side) {
  return 2 * images::kTiffPixelBytes * side * side + 3 * images::kTiffTileBytes;
}

std::uint64_t windows_across(std::uint32_t pixels, std::uint32_t side) {
  return (pixels + side - 1) / side;
}

/// Returns the first and last window of an axis that pixels from `least` to `most` touch, a pixel
/// more on both sides for what is rounded.
struct WindowRange {
  std::uint64_t first = 1, last = 0;
};
WindowRange range_of(double least, double most, std::uint32_t pixels, std::uint32_t side) {
  if (!(most >= -1) || !(least <= pixels + 1.0))
    return {};
  const double end = pixels - 1.0;
  return {static_cast<std::uint64_t>(std::clamp(least - 1, 0.0, end)) / side,
          static_cast<std::uint64_t>(std::clamp(most + 1, 0.0, end)) / side};
}

}  // namespace

std::uint64_t drawn_bytes(const TileRecord& record, std::size_t channels, bool has_colours) {
  // The tile as it was read, the part made of it, and its places and lights.
  const std::uint64_t vertices =
      std::uint64_t{record.own_count} + record.ghost_count + record.copy_count + record.split_count;
  const std::uint64_t triangles = std::uint64_t{record.interior_count} + record.border_count;
  const std::uint64_t texels =
      has_colours ? std::uint64_t{record.image_width} * record.image_height : 0;
  return record.file_bytes + vertices * (160 + 2 * sizeof(float) * channels) + triangles * 72 +
         texels * 10;
}

WindowPlan plan_windows(const PixelGrid& grid, std::uint64_t tile_bytes,
                        std::uint64_t budget_bytes) {
  const std::size_t threads =
      execution::useful_blocks(std::numeric_limits<std::uint64_t>::max(), 1) / 2;
  const std::uint64_t memory = budget_bytes / 2;
  const auto block = [&](std::uint32_t side) { return window_bytes(side) + tile_bytes; };
  std::uint32_t side = kTiffTileSide;
  if (block(side) > memory) {
    constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
    throw Error(ErrorCode::budget,
                fmt::format("a raster of these tiles needs --memory-budget {} or more",
                            execution::exact_size_text((2 * block(side) / kMiB + 1) * kMiB)));
  }
  const auto keeps_all_at_work = [&](std::uint32_t larger) {
    const std::uint64_t windows =
        windows_across(grid.width, larger) * windows_across(grid.height, larger);
    return block(larger) <= memory / (2 * threads) && windows >= 2 * threads;
  };
  while (side < kMostTilesASide * kTiffTileSide && keeps_all_at_work(2 * side))
    side *= 2;
  return {side, execution::useful_blocks(memory, block(side))};
}

std::vector<PlannedWindow> windows_over(const MapFrame& frame, const PixelGrid& grid,
                                        std::uint32_t side, std::span<const BoundsD> boxes) {
  const std::uint64_t across = windows_across(grid.width, side);
  std::vector<PlannedWindow> windows;
  for (std::uint32_t row = 0; row < grid.height; row += side) {
    for (std::uint32_t column = 0; column < grid.width; column += side)
      windows.push_back(
          {{column, row, std::min(side, grid.width - column), std::min(side, grid.height - row)}});
  }
  for (std::size_t tile = 0; tile < boxes.size(); ++tile) {
    if (boxes[tile].empty())
      continue;
    const BoundsD map = frame.around(boxes[tile]);
    const Vec3d first = grid.on_grid({map.min.x, map.max.y, 0}),
                last = grid.on_grid({map.max.x, map.min.y, 0});
    const WindowRange columns = range_of(first.x, last.x, grid.width, side);
    const WindowRange rows = range_of(first.y, last.y, grid.height, side);
    for (std::uint64_t row = rows.first; row <= rows.last; ++row) {
      for (std::uint64_t column = columns.first; column <= columns.last; ++column)
        windows[row * across + column].tiles.push_back(static_cast<std::uint32_t>(tile));
    }
  }
  return windows;
}

}  // namespace meshhier::exporting
