// The model seen straight from above: an orthophoto, and the heights of the highest surface (a
// digital surface model), as GeoTIFFs.
//
// Problem. A raster has more pixels, and the model more tiles, than memory holds.
// Idea. Windows of pixels are drawn side by side, each from the tiles that lie there, at the level
// that fits a pixel. What is drawn is packed tile by tile, and put together at the end.
//
//   cut of the hierarchy            windows of the raster          files
//     errors <= half a pixel   ->     tiles over each one     ->     packed tiles, overviews, head
//
// Invariant. A pixel depends on the cut and on the raster's place alone: the files are the same for
// any number of threads and any budget. Each is complete or not there; the
// orthophoto gets its name first.
//
// Cost. A tile is read once for each window that it touches, and, if the cut mixes levels, once
// before. Memory: for each thread a window and a tile.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "export/export.h"
#include "export/plan_region.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::exporting {

struct RasterOptions {
  /// At least one of them is given; at most one is a stream.
  std::filesystem::path picture{}, heights{};
  /// A pixel's side in units of the map, of metres on the globe, else of the input. None: about as
  /// fine as the model's finest detail.
  std::optional<double> pixel{};
  PlanPoint corner{};  ///< a place where pixels have a corner
  /// A level, a cut or tiles by their error. None: those of cut_for_pixels().
  std::optional<ExportSelection> selection{};
  std::uint64_t memory_budget = std::uint64_t{1} << 30;  ///< bytes
  bool replace = false;    ///< takes the place of files that are there
  RegionRequest region{};  ///< nothing is drawn beyond it
};

/// Returns whether a name is that of a raster: NAME.tif, NAME.tiff.
bool is_raster_name(const std::filesystem::path& output);

/// Draws the hierarchy and returns a line for people. Pictures are red, green, blue and alpha,
/// which is 0 where nothing is; heights are floats, kNoHeight where nothing is. Both are tiled,
/// packed by DEFLATE, with overviews, and lie on the map as MapFrame says.
///
/// Throws Error(usage) if an output is no raster by its name, or replaces what is read, if the
/// raster has too many pixels, if the mesh has no triangles, if nothing lies in the region, or as
/// export_mesh() does for a selection; Error(budget) with the smallest budget that would do;
/// Error(io | corrupt | exists | input | interrupted).
std::string export_rasters(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                           const RasterOptions& options, execution::Progress& progress,
                           const execution::CancelToken& cancel);

}  // namespace meshhier::exporting
