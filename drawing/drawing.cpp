#include "drawing/drawing.h"

#include "base/error.h"
#include "drawing/draw_lines.h"
#include "drawing/draw_picture.h"
#include "drawing/line_formats.h"
#include "export/manifest_config.h"
#include "geodesy/map_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::drawing {
namespace {

const UnitRow* unit_of_metres(double metres) {
  constexpr double kSame = 1e-9;
  const auto* const row = std::ranges::find_if(kUnits, [&](const UnitRow& unit) {
    return std::abs(unit.metres - metres) <= kSame * metres;
  });
  return row == kUnits.end() ? nullptr : row;
}

/// Returns metres of the unit of the map that the model lies on; 0 if it lies on none.
double metres_on_map(const storage::Manifest& manifest, const exporting::MapFrame& map) {
  if (map.is_on_globe)
    return 1;
  const auto crs = exporting::config_of(manifest).placement.crs;
  return crs && !map.name.empty() ? geodesy::MapProjection(*crs).unit_metres() : 0;
}

bool cuts(const DrawingOptions& options) {
  return options.contours || !options.cut_heights.empty();
}

void require_sense(const DrawingOptions& options, const LineFormat* lines) {
  const bool is_plan = std::holds_alternative<PlanFromAbove>(options.view);
  if (!is_plan && cuts(options)) {
    throw Error(ErrorCode::usage,
                "--cut-height and --contours cut a plan: leave out --elevation, --section or "
                "--plane");
  }
  if (options.contours && !options.cut_heights.empty())
    throw Error(ErrorCode::usage, "--contours and --cut-height exclude each other");
  const bool has_lines = cuts(options) || std::holds_alternative<SectionLine>(options.view) ||
                         std::holds_alternative<SectionPlane>(options.view);
  if (lines != nullptr && !has_lines) {
    throw Error(ErrorCode::usage,
                fmt::format("{} takes the lines of a cut: give --cut-height, --section, --plane or "
                            "--contours; a view without one is a picture, .png",
                            lines->name));
  }
  if (options.has_world_file && (!is_plan || lines != nullptr))
    throw Error(ErrorCode::usage, "--world-file belongs to the picture of a plan");
}

/// Warns of options that the format has no use for.
void warn_of_unused(const DrawingOptions& options, const LineFormat* lines,
                    execution::Progress& progress) {
  const std::string_view format = lines == nullptr ? kPictureFormat : lines->name;
  const bool is_paper = lines == nullptr || lines->needs_paper;
  const std::array unused{
      std::pair{lines != nullptr && options.dots_per_inch != DrawingOptions{}.dots_per_inch,
                "--dpi"},
      std::pair{lines != nullptr && options.is_transparent, "--transparent"},
      std::pair{!is_paper && options.paper.has_grid, "--grid"},
      std::pair{options.is_flat && format != "dxf", "--flat"}};
  for (const auto& [is_unused, name] : unused) {
    if (is_unused)
      progress.warn(fmt::format("{} has no meaning for {}", name, format));
  }
}

/// Returns a length in the sheet's unit. `option`: which asked for it.
double on_sheet(const Length& length, const SheetUnit& unit, std::string_view option) {
  if (length.unit && unit.metres == 0) {
    throw Error(ErrorCode::usage,
                fmt::format("{} {:.12g}{}: the unit of the model's coordinates is not known: give "
                            "--units m, or the one that it is, or leave the unit out",
                            option, length.number, name_of(*length.unit)));
  }
  return length.in(unit.metres);
}

void take_lengths(const DrawingOptions& options, Asked& asked) {
  for (const Length& height : options.cut_heights)
    asked.cut_heights.push_back(on_sheet(height, asked.unit, "--cut-height"));
  if (options.contours)
    asked.contours = on_sheet(*options.contours, asked.unit, "--contours");
}

}  // namespace

std::vector<std::string> format_names() {
  std::vector<std::string> names{std::string(kPictureFormat)};
  for (const LineFormat& format : kLineFormats)
    names.emplace_back(format.name);
  return names;
}

std::string draw(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                 const DrawingOptions& options, execution::Progress& progress,
                 const execution::CancelToken& cancel) {
  const auto* const format = std::ranges::find(kLineFormats, options.format, &LineFormat::name);
  const bool is_lines = format != kLineFormats.end();
  require_sense(options, is_lines ? format : nullptr);
  warn_of_unused(options, is_lines ? format : nullptr, progress);
  return is_lines ? draw_lines(files, hierarchy, options, *format, progress, cancel)
                  : draw_picture(files, hierarchy, options, progress, cancel);
}

Asked asked_of(const storage::Manifest& manifest, const DrawingOptions& options) {
  Asked asked{.sheet = sheet_of(manifest, options.view)};
  double metres = metres_on_map(manifest, asked.sheet.map);
  if (metres > 0 && options.units && metres_of(*options.units) != metres) {
    throw Error(ErrorCode::usage,
                fmt::format("--units {}: the model lies on {}, which has its own unit",
                            name_of(*options.units), asked.sheet.map.name));
  }
  const std::optional<Unit> told = manifest.units ? manifest.units : options.units;
  if (metres == 0 && manifest.units && options.units && *options.units != *manifest.units) {
    throw Error(ErrorCode::usage, fmt::format("--units {}: the hierarchy says that its unit is {}",
                                              name_of(*options.units), name_of(*manifest.units)));
  }
  if (metres == 0 && told)
    metres = metres_of(*told);
  asked.unit.metres = metres;
  if (const UnitRow* row = metres > 0 ? unit_of_metres(metres) : nullptr) {
    asked.unit.name = row->name;
    asked.named_unit = row->value;
  }
  take_lengths(options, asked);
  return asked;
}

CutLevels levels_of(const Asked& asked, double low, double high) {
  if (asked.contours)
    return CutLevels::contours(*asked.contours, low, high);
  if (asked.sheet.plane)
    return CutLevels({*asked.sheet.plane});
  return CutLevels(asked.cut_heights);
}

}  // namespace meshhier::drawing
