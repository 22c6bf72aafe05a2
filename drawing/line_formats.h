// The formats of lines. Each is a row of kLineFormats and a file.
#pragma once

#include "drawing/levels.h"
#include "drawing/line_store.h"
#include "drawing/paper.h"
#include "drawing/view.h"
#include "export/byte_stream.h"
#include "hierarchy/unit.h"
#include "storage/format/manifest.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::drawing {

/// All that a file of lines tells besides them. Outlives its writer.
struct LineDrawing {
  const storage::Manifest& manifest;
  Sheet sheet;
  CutLevels levels;
  bool are_contours = false;
  SheetUnit unit{};
  std::optional<Unit> named_unit{};  ///< none: another one, or not known
  BoundsD box{};                     ///< around the lines, in the sheet's coordinates
  /// Lines lie on the sheet and not in space, where the format can tell them apart.
  bool is_flat = false;
  std::optional<Paper> paper{};  ///< of formats that have one, or if its scale was given
  std::string title{};           ///< of the hierarchy
};

/// Writes the file: the head when it is made, the lines, then the rest.
class LineWriter : public LineSink {
 public:
  /// Required after the last line.
  virtual void finish() = 0;
};

/// All write into a stream that outlives them; each throws what that throws.
std::unique_ptr<LineWriter> svg_writer(const LineDrawing& drawing, exporting::ByteStream& out);
std::unique_ptr<LineWriter> dxf_writer(const LineDrawing& drawing, exporting::ByteStream& out);
/// Throws Error(usage) if a place has no longitude and latitude; and as geodesy::MapChange.
std::unique_ptr<LineWriter> geojson_writer(const LineDrawing& drawing, exporting::ByteStream& out);

struct LineFormat {
  std::string_view name;     ///< also what names of files end in
  bool needs_paper = false;  ///< it has a scale
  std::unique_ptr<LineWriter> (*open)(const LineDrawing& drawing, exporting::ByteStream& out);
};
inline constexpr std::array kLineFormats{LineFormat{"svg", true, svg_writer},
                                         LineFormat{"dxf", false, dxf_writer},
                                         LineFormat{"geojson", false, geojson_writer}};

/// Whether lines have longitudes and latitudes in GeoJSON, as RFC 7946 wants it.
bool has_place_on_globe(const storage::Manifest& manifest);

/// Returns the name of a level: "12.5".
std::string level_text(double height);

}  // namespace meshhier::drawing
