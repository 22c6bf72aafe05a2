#include "export/orthophoto.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/parallel.h"
#include "export/cut_part.h"
#include "export/drawn_cut.h"
#include "export/map_frame.h"
#include "export/named_cut.h"
#include "export/pixel_grid.h"
#include "export/plan_part.h"
#include "export/plan_windows.h"
#include "export/raster_detail.h"
#include "export/raster_pyramid.h"
#include "images/tiff_file.h"
#include "render/plan_raster.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/work_directory.h"
#include "storage/io/little_endian.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;
using images::kTiffTileSide;
using images::TiffPixel;
using storage::HierarchyReader;

// ---- what is drawn ------------------------------------------------------------------------------

NamedCut chosen_cut(storage::FileSystem& files, const HierarchyReader& reader,
                    const RasterOptions& options, const MapFrame& frame, double pixel) {
  if (!options.selection)
    return cut_for_pixels(
        reader, frame, pixel,
        options.heights.empty() ? VertexUse::picture : VertexUse::picture_and_heights);
  std::optional<NamedCut> cut = cut_of(files, reader, *options.selection);
  if (!cut) {
    throw Error(ErrorCode::usage,
                "a raster shows all that is seen from above: a level, a cut or what an error "
                "allows, no single node and no outline");
  }
  return std::move(*cut);
}

// ---- drawing ------------------------------------------------------------------------------------

/// All that drawing needs, the same for all windows.
struct Drawing {
  DrawnCut shown;
  PlanView view;
};

/// The rasters that are asked for.
struct Pyramids {
  std::optional<RasterPyramid> picture, heights;
};

/// A height as the file has it: none is taken for that of nothing.
float height_in_file(float height) {
  if (height == render::PlanRaster::kNothing)
    return kNoHeight;
  return height == kNoHeight ? std::nextafter(kNoHeight, 0.0F) : height;
}

/// Copies a tile of the file out of a window. `pixel(i)`: the bytes of the window's pixel i.
template <class Pixel>
std::vector<std::byte> tile_of(const render::PlanWindow& window, std::uint32_t x, std::uint32_t y,
                               const Pixel& pixel) {
  std::vector<std::byte> tile(images::kTiffTileBytes);
  const std::uint32_t width = std::min(kTiffTileSide, window.width - x);
  const std::uint32_t height = std::min(kTiffTileSide, window.height - y);
  for (std::uint32_t row = 0; row < height; ++row) {
    std::byte* to = tile.data() + std::size_t{row} * kTiffTileSide * images::kTiffPixelBytes;
    const std::size_t first = std::size_t{y + row} * window.width + x;
    for (std::size_t i = first; i < first + width; ++i, to += images::kTiffPixelBytes)
      pixel(i, to);
  }
  return tile;
}

void put_tiles(const render::PlanWindow& window, const render::PlanRaster& raster,
               Pyramids& pyramids) {
  for (std::uint32_t y = 0; y < window.height; y += kTiffTileSide) {
    for (std::uint32_t x = 0; x < window.width; x += kTiffTileSide) {
      const std::uint32_t column = (window.column + x) / kTiffTileSide,
                          row = (window.row + y) / kTiffTileSide;
      if (pyramids.picture) {
        pyramids.picture->put(column, row, tile_of(window, x, y, [&](std::size_t i, std::byte* to) {
                                std::memcpy(to, &raster.colours()[4 * i], 4);
                              }));
      }
      if (pyramids.heights) {
        pyramids.heights->put(column, row, tile_of(window, x, y, [&](std::size_t i, std::byte* to) {
                                storage::store_little(height_in_file(raster.heights()[i]), to);
                              }));
      }
    }
  }
}

/// Draws a window and returns how many of its pixels are covered.
std::uint64_t draw_window(const Drawing& drawing, const PlannedWindow& planned, CutParts& parts,
                          Pyramids& pyramids, execution::Progress& progress) {
  render::PlanRaster raster(planned.window, drawing.view.has_colours);
  for (const std::uint32_t tile : planned.tiles) {
    raster.draw(plan_mesh(drawing.view, drawing.shown.load(parts, tile),
                          "the picture of tile " + to_text(drawing.shown.cut[tile])));
    progress.advance(1);
  }
  put_tiles(planned.window, raster, pyramids);
  return raster.heights().size() - static_cast<std::uint64_t>(std::ranges::count(
                                       raster.heights(), render::PlanRaster::kNothing));
}

// ---- the files ----------------------------------------------------------------------------------

std::uint16_t tag(images::GeoTag name) {
  return static_cast<std::uint16_t>(name);
}

std::vector<images::TiffField> geo_fields(const PixelGrid& grid, const geodesy::GeoKeys& keys) {
  using images::GeoTag;
  const std::array scale{grid.size, grid.size, 0.0};
  const std::array tie{0.0, 0.0, 0.0, grid.left, grid.top, 0.0};
  std::vector<images::TiffField> fields{images::tiff_doubles(tag(GeoTag::pixel_scale), scale),
                                        images::tiff_doubles(tag(GeoTag::tie_points), tie)};
  if (!keys.directory.empty())
    fields.push_back(images::tiff_shorts(tag(GeoTag::key_directory), keys.directory));
  if (!keys.doubles.empty())
    fields.push_back(images::tiff_doubles(tag(GeoTag::double_params), keys.doubles));
  if (!keys.text.empty())
    fields.push_back(images::tiff_text(tag(GeoTag::ascii_params), keys.text));
  return fields;
}

/// The output of one raster, from its refusals on.
struct RasterOutput {
  RasterOutput(storage::FileSystem& files, const storage::OutputRequest& request,
               const execution::CancelToken& cancel, storage::MemoryPool& pool)
      : file(files, request, [&cancel] { cancel.check(); }), scratch(files, file.scratch(), pool) {}

  storage::OutputFile file;
  storage::ScratchFile scratch;
};

std::unique_ptr<RasterOutput> open_output(storage::FileSystem& files, const fs::path& path,
                                          const fs::path& other, const fs::path& hierarchy,
                                          const RasterOptions& options,
                                          const execution::CancelToken& cancel,
                                          storage::MemoryPool& pool) {
  if (path.empty())
    return nullptr;
  if (!storage::is_standard_output(files, path)) {
    storage::require_outside(files, path);
    if (!is_raster_name(path) && files.kind(path) != storage::FileKind::stream) {
      throw Error(ErrorCode::usage,
                  path.string() + ": a raster is a GeoTIFF; give it a name that ends in .tif");
    }
  } else if (storage::is_standard_output(files, other)) {
    throw Error(ErrorCode::usage, "standard output takes one raster; give the other one a name");
  }
  storage::OutputRequest request{path, options.replace, {hierarchy, options.region.polygon}};
  if (options.selection) {
    if (const auto* cut = std::get_if<fs::path>(&*options.selection))
      request.inputs.push_back(*cut);
  }
  if (!storage::is_standard_output(files, other))
    request.inputs.push_back(other);
  return std::make_unique<RasterOutput>(files, request, cancel, pool);
}

/// Where the rasters go; a null one is not asked for.
struct RasterOutputs {
  std::unique_ptr<RasterOutput> picture, heights;
};

RasterOutputs open_outputs(storage::FileSystem& files, const fs::path& hierarchy,
                           const RasterOptions& options, const execution::CancelToken& cancel,
                           storage::MemoryPool& pool) {
  const auto open = [&](const fs::path& path, const fs::path& other) {
    return open_output(files, path, other, hierarchy, options, cancel, pool);
  };
  return {open(options.picture, options.heights), open(options.heights, options.picture)};
}

void write_rasters(const Pyramids& pyramids, const PlanView& view, const std::string& licence,
                   const RasterOutputs& outputs, const execution::CancelToken& cancel) {
  const auto fields_of = [&](const geodesy::GeoKeys& keys) {
    std::vector<images::TiffField> fields = geo_fields(view.grid, keys);
    if (!licence.empty())
      fields.push_back(images::tiff_text(TIFFTAG_COPYRIGHT, licence));
    return fields;
  };
  if (outputs.picture) {
    pyramids.picture->write(*outputs.picture->file.file(), fields_of(view.frame.picture_keys),
                            cancel);
  }
  if (outputs.heights) {
    std::vector<images::TiffField> fields = fields_of(view.frame.height_keys);
    fields.push_back(
        images::tiff_text(tag(images::GeoTag::gdal_nodata), fmt::format("{}", kNoHeight)));
    pyramids.heights->write(*outputs.heights->file.file(), fields, cancel);
  }
  std::vector<storage::OutputFile*> files;
  for (RasterOutput* output : {outputs.picture.get(), outputs.heights.get()}) {
    if (output != nullptr)
      files.push_back(&output->file);
  }
  storage::publish_all(files);
}

/// What was drawn, for people.
struct Drawn {
  std::size_t tiles = 0;      ///< tiles of the hierarchy
  std::uint64_t covered = 0;  ///< pixels
};

std::string raster_text(const RasterOptions& options, const PlanView& view, const std::string& cut,
                        const Drawn& drawn) {
  const PixelGrid& grid = view.grid;
  const bool are_both = !options.picture.empty() && !options.heights.empty();
  const double all = double{1} * grid.width * grid.height;
  return fmt::format(
      "{}{}: {} x {} pixels of {}{}, {:.1f} % of them covered; {}, {}; {}",
      (options.picture.empty() ? options.heights : options.picture).string(),
      are_both ? " and " + options.heights.string() : "", grid.width, grid.height, grid.size,
      options.pixel ? "" : " (about as fine as the input; --gsd says another)",
      100.0 * static_cast<double>(drawn.covered) / all, cut, counted(drawn.tiles, "tiles"),
      view.frame.name.empty() ? "on no map, in the input's coordinates" : "on " + view.frame.name);
}

/// Draws all windows.
Drawn draw(const Drawing& drawing, std::uint64_t memory_budget, Pyramids& pyramids,
           execution::Progress& progress) {
  const PlanView& view = drawing.view;
  std::uint64_t tile_bytes = 0;
  for (const NodeId node : drawing.shown.cut.nodes()) {
    tile_bytes = std::max(tile_bytes, drawn_bytes(drawing.shown.reader.record(node),
                                                  static_cast<std::size_t>(view.layout.channels()),
                                                  view.has_colours));
  }
  const WindowPlan plan = plan_windows(view.grid, tile_bytes, memory_budget);
  Benches benches(drawing.shown, plan.in_flight, memory_budget / 8);
  const std::vector<BoundsD> boxes = boxes_of(drawing.shown, benches, progress);
  const std::vector<PlannedWindow> windows = windows_over(view.frame, view.grid, plan.side, boxes);
  std::uint64_t steps = 0;
  for (const PlannedWindow& window : windows)
    steps += window.tiles.size();
  progress.stage("draw", steps, "tiles");
  Drawn drawn{boxes.size() - static_cast<std::size_t>(std::ranges::count(boxes, BoundsD{})), 0};
  execution::ordered_for(
      windows.size(), benches.size(), drawing.shown.cancel,
      [&](std::size_t i) {
        return draw_window(drawing, windows[i], benches.of(i), pyramids, progress);
      },
      [&](std::size_t, std::uint64_t count) { drawn.covered += count; });
  return drawn;
}

void make_overviews(Pyramids& pyramids, execution::Progress& progress,
                    const execution::CancelToken& cancel) {
  std::size_t tiles = 0;
  for (const auto* pyramid : {&pyramids.picture, &pyramids.heights})
    tiles += *pyramid ? (*pyramid)->overview_tiles() : 0;
  progress.stage("overviews", tiles, "tiles");
  for (auto* pyramid : {&pyramids.picture, &pyramids.heights}) {
    if (*pyramid)
      (*pyramid)->make_overviews(cancel, [&] { progress.advance(1); });
  }
}

}  // namespace

bool is_raster_name(const fs::path& output) {
  const std::string ending = storage::lower_extension(output);
  return ending == ".tif" || ending == ".tiff";
}

std::string export_rasters(storage::FileSystem& files, const fs::path& hierarchy,
                           const RasterOptions& options, execution::Progress& progress,
                           const execution::CancelToken& cancel) {
  storage::MemoryPool pool(options.memory_budget / 8);
  const RasterOutputs outputs = open_outputs(files, hierarchy, options, cancel, pool);
  const storage::HierarchyFiles place(files, hierarchy);
  const HierarchyReader reader(place.files(), hierarchy);
  require_surface(reader, "a raster");

  PlanView view{.frame = map_frame(reader.manifest()),
                .grid = {},
                .layout = reader.tile_format().attributes,
                .has_colours = outputs.picture != nullptr};
  const double pixel = options.pixel ? *options.pixel : finest_detail(reader, view.frame);
  NamedCut cut = chosen_cut(files, reader, options, view.frame, pixel);
  std::optional<Region> region;
  if (options.region.is_any())
    region = region_of(files, reader, options.region, cancel);
  const BoundsD box = drawn_box(reader, view.frame, options.region, region);
  if (box.empty())
    fail_empty(reader, options.region);
  view.grid = grid_over(box, pixel, options.corner);

  Pyramids pyramids;
  const images::TexelSize size{view.grid.width, view.grid.height};
  if (outputs.picture)
    pyramids.picture.emplace(TiffPixel::rgba, size, outputs.picture->scratch);
  if (outputs.heights)
    pyramids.heights.emplace(TiffPixel::height, size, outputs.heights->scratch);
  const Drawing drawing{{reader, std::move(cut.cut), std::move(region), cancel}, view};
  const Drawn drawn = draw(drawing, options.memory_budget, pyramids, progress);
  if (drawn.covered == 0 && drawing.shown.region)
    fail_empty(reader, options.region);
  if (drawn.covered == 0) {
    throw Error(ErrorCode::usage,
                "the surface covers the middle of no pixel: give a smaller --gsd, unless it stands "
                "upright");
  }
  make_overviews(pyramids, progress, cancel);
  write_rasters(pyramids, view, reader.manifest().licence, outputs, cancel);
  return raster_text(options, view, cut.name, drawn);
}

}  // namespace meshhier::exporting
