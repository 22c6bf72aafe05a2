// Drawings of a hierarchy, at a scale: plans, elevations and sections as pictures; sections and
// contour lines as lines.
#pragma once

#include "drawing/levels.h"
#include "drawing/paper.h"
#include "drawing/view.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "export/export.h"
#include "hierarchy/length.h"
#include "hierarchy/unit.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::drawing {

struct DrawingOptions {
  std::filesystem::path output{};
  std::string format{};  ///< "png" or a name of kLineFormats
  bool replace = false;
  View view{};
  /// Heights of a plan's cuts: its picture shows what lies below the highest one.
  std::vector<Length> cut_heights{};
  std::optional<Length> contours{};  ///< a plan's interval, above 0
  PaperRequest paper{};
  std::optional<Unit> units{};  ///< of the input's coordinates, where the hierarchy tells none
  double dots_per_inch = 300;   ///< of pictures
  bool is_transparent = false;  ///< a picture where nothing is drawn; else it is white
  bool has_world_file = false;  ///< beside the picture of a plan
  bool is_flat = false;         ///< lines of sections lie on the sheet, in DXF
  /// A level, or tiles by their error. None: the original for lines, tiles as fine as pixels for
  /// pictures.
  std::optional<exporting::ExportSelection> selection{};
  std::uint64_t memory_budget = std::uint64_t{1} << 30;
  exporting::RegionRequest region{};  ///< nothing is drawn beyond it
};

inline constexpr std::string_view kPictureFormat = "png";

/// Returns the names of all formats.
std::vector<std::string> format_names();

/// Makes the drawing and returns a text for people. Throws Error(usage) for options that
/// contradict each other, a scale that cannot be, or if nothing is drawn; Error(budget) with the
/// smallest budget that would do; Error(io | corrupt | exists | input | interrupted).
std::string draw(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                 const DrawingOptions& options, execution::Progress& progress,
                 const execution::CancelToken& cancel);

/// What lines and pictures have in common: the options, looked at with the hierarchy.
struct Asked {
  Sheet sheet;
  SheetUnit unit{};
  std::optional<Unit> named_unit{};
  std::vector<double> cut_heights{};  ///< in that unit
  std::optional<double> contours{};
};
/// Throws Error(usage) for a unit that contradicts the map's, or lengths with a unit where that of
/// the sheet is not known; and as sheet_of().
Asked asked_of(const storage::Manifest& manifest, const DrawingOptions& options);

/// Returns the levels that are asked for: the view's plane, or heights, or contours of what lies
/// between `low` and `high` above the sheet. Throws as CutLevels::contours().
CutLevels levels_of(const Asked& asked, double low, double high);

}  // namespace meshhier::drawing
