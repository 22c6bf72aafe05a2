#include "drawing/draw_lines.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "drawing/line_store.h"
#include "drawing/tile_lines.h"
#include "execution/parallel.h"
#include "execution/size_text.h"
#include "export/drawn_cut.h"
#include "export/named_cut.h"
#include "export/plan_windows.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::drawing {
namespace {

using exporting::Benches;
using exporting::DrawnCut;
using storage::HierarchyReader;

exporting::NamedCut chosen_cut(storage::FileSystem& files, const HierarchyReader& reader,
                               const DrawingOptions& options) {
  if (options.selection)
    return *exporting::cut_of(files, reader, *options.selection);
  return {Cut::of_level(reader.tree(), reader.tree().depth()), "the original"};
}

/// Returns the tiles that levels may pass.
std::vector<std::size_t> tiles_passed(std::span<const BoundsD> boxes, const LineDrawing& drawing) {
  constexpr double kRounding = 0x1p-40;
  std::vector<std::size_t> tiles;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty())
      continue;
    const BoundsD box = drawing.sheet.view.around(boxes[i]);
    const double slack =
        kRounding * (std::abs(box.min.z) + std::abs(box.max.z) + length(drawing.sheet.view.shift));
    if (!drawing.levels.between(box.min.z - slack, box.max.z + slack).empty())
      tiles.push_back(i);
  }
  return tiles;
}

/// The lines of a tile, and the box around them on the sheet.
struct BoxedLines {
  TileLines lines;
  BoundsD box;
};

/// Cuts tiles; each takes no more than its part of the memory.
class TileCutter {
 public:
  TileCutter(const DrawnCut& shown, const LineDrawing& drawing, std::uint64_t memory_bytes)
      : shown_(shown), drawing_(drawing), memory_(memory_bytes) {
    std::uint64_t most = 0;
    for (const NodeId node : shown.cut.nodes()) {
      most = std::max(
          most,
          exporting::drawn_bytes(
              shown.reader.record(node),
              static_cast<std::size_t>(shown.reader.tile_format().attributes.channels()), false));
    }
    constexpr std::uint64_t kUsualSegments = 1 << 16;
    most_bytes_ = most;
    in_flight_ = execution::useful_blocks(memory_, most + kUsualSegments * kSegmentBytes);
    most_segments_ = (memory_ / in_flight_ - std::min(most, memory_ / in_flight_)) / kSegmentBytes;
  }

  std::size_t in_flight() const { return in_flight_; }

  BoxedLines cut(exporting::CutParts& parts, std::size_t tile) const {
    const exporting::CutPart part = shown_.load(parts, tile);
    const SlicedPart sliced(part, drawing_.sheet.view);
    require_room(sliced.count_segments(drawing_.levels), tile);
    BoxedLines cut{tile_lines(sliced, drawing_.levels), {}};
    for (const Vec3d& point : cut.lines.points)
      cut.box.add(drawing_.sheet.view.of_input(point));
    return cut;
  }

 private:
  void require_room(std::uint64_t segments, std::size_t tile) const {
    if (segments <= most_segments_)
      return;
    constexpr std::uint64_t kParts = 4;  // of the budget that are for tiles: one
    throw Error(
        ErrorCode::budget,
        fmt::format("{} segments of lines pass through tile {}: give --memory-budget {} or "
                    "more, or a larger interval",
                    segments, to_text(shown_.cut[tile]),
                    execution::rounded_size_text(kParts * in_flight_ *
                                                 (most_bytes_ + 2 * segments * kSegmentBytes))));
  }

  const DrawnCut& shown_;
  const LineDrawing& drawing_;
  std::uint64_t memory_;
  std::uint64_t most_bytes_ = 0;  ///< of a tile
  std::size_t in_flight_ = 1;
  std::uint64_t most_segments_ = 0;
};

/// What was written, for people.
struct Written {
  std::uint64_t lines = 0, closed = 0, points = 0;
  double length = 0;
};

/// Counts what it hands on.
class CountingSink final : public LineSink {
 public:
  CountingSink(LineWriter& to, Written& written, execution::Progress& progress)
      : to_(to), written_(written), progress_(progress) {}
  void begin(const JoinedLine& line) override {
    ++written_.lines;
    written_.closed += line.is_closed ? 1 : 0;
    written_.points += line.points;
    written_.length += line.length;
    to_.begin(line);
  }
  void point(Vec3d place) override { to_.point(place); }
  void end() override {
    to_.end();
    progress_.advance(1);
  }

 private:
  LineWriter& to_;
  Written& written_;
  execution::Progress& progress_;
};

[[noreturn]] void fail_without_lines(const LineDrawing& drawing, const BoundsD& box) {
  if (drawing.sheet.plane) {
    throw Error(ErrorCode::usage,
                fmt::format("the plane cuts nothing: what there is lies from {:.6g} to {:.6g} in "
                            "front of it",
                            box.min.z - *drawing.sheet.plane, box.max.z - *drawing.sheet.plane));
  }
  throw Error(ErrorCode::usage, fmt::format("nothing is cut: what there is lies at heights from "
                                            "{:.6g} to {:.6g}",
                                            box.min.z, box.max.z));
}

/// Cuts all tiles that are passed into the store; returns the box around the lines.
BoundsD cut_tiles(const DrawnCut& shown, const LineDrawing& drawing, std::uint64_t memory_bytes,
                  LineStore& store, execution::Progress& progress) {
  const TileCutter cutter(shown, drawing, memory_bytes);
  Benches benches(shown, cutter.in_flight(), memory_bytes / 4);
  const std::vector<std::size_t> tiles =
      tiles_passed(exporting::boxes_of(shown, benches, progress), drawing);
  std::vector<NodeId> nodes;
  for (const std::size_t tile : tiles)
    nodes.push_back(shown.cut[tile]);
  shown.reader.will_read(nodes);
  progress.stage("cut", tiles.size(), "tiles");
  BoundsD box;
  execution::ordered_for(
      tiles.size(), benches.size(), shown.cancel,
      [&](std::size_t i) { return cutter.cut(benches.of(i), tiles[i]); },
      [&](std::size_t, const BoxedLines& cut) {
        store.add(cut.lines);
        box.add(cut.box);
        progress.advance(1);
      });
  return box;
}

Written write_lines(const LineFormat& format, const LineDrawing& drawing, const LineStore& store,
                    storage::File& file, execution::Progress& progress) {
  exporting::ByteStream out(file);
  const std::unique_ptr<LineWriter> writer = format.open(drawing, out);
  Written written;
  progress.stage("write", store.size(), "lines");
  CountingSink sink(*writer, written, progress);
  store.for_each_line(sink);
  writer->finish();
  out.flush();
  return written;
}

std::string text_of(const DrawingOptions& options, const LineDrawing& drawing,
                    const std::string& cut, const Written& written) {
  const double length = written.length * drawing.sheet.map.scale();
  const std::string paper =
      drawing.paper ? fmt::format("; {}, {:.0f} x {:.0f} mm", scale_text(drawing.paper->scale),
                                  drawing.paper->width, drawing.paper->height)
                    : "";
  const std::string& map = drawing.sheet.map.name;
  return fmt::format("{}: {} at {}, {} of them closed, {} of length {:.6g}{}{}; {}; {}",
                     options.output.string(), counted(written.lines, "lines"),
                     counted(drawing.levels.size(), "heights"), written.closed,
                     counted(written.points, "points"), length,
                     drawing.unit.name.empty() ? "" : " ", drawing.unit.name, cut + paper,
                     map.empty() ? "on no map, in the model's coordinates" : "on " + map);
}

}  // namespace

std::string draw_lines(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                       const DrawingOptions& options, const LineFormat& format,
                       execution::Progress& progress, const execution::CancelToken& cancel) {
  if (!storage::is_standard_output(files, options.output))
    storage::require_outside(files, options.output);
  storage::OutputFile output(files,
                             {options.output, options.replace, {hierarchy, options.region.polygon}},
                             [&cancel] { cancel.check(); });
  storage::MemoryPool pool(options.memory_budget / 4);
  storage::ScratchFile scratch(files, output.scratch(), pool);
  const storage::HierarchyFiles place(files, hierarchy);
  const HierarchyReader reader(place.files(), hierarchy);
  exporting::require_surface(reader, "a drawing");
  const Asked asked = asked_of(reader.manifest(), options);
  exporting::NamedCut cut = chosen_cut(files, reader, options);
  std::optional<exporting::Region> region;
  if (options.region.is_any())
    region = exporting::region_of(files, reader, options.region, cancel);
  const BoundsD all = exporting::drawn_box(reader, asked.sheet.view, options.region, region);
  if (all.empty())
    exporting::fail_empty(reader, options.region);

  LineDrawing drawing{.manifest = reader.manifest(),
                      .sheet = asked.sheet,
                      .levels = levels_of(asked, all.min.z, all.max.z),
                      .are_contours = options.contours.has_value(),
                      .unit = asked.unit,
                      .named_unit = asked.named_unit,
                      .is_flat = options.is_flat,
                      .title = hierarchy.filename().string()};
  const DrawnCut shown{reader, std::move(cut.cut), std::move(region), cancel};
  LineStore store(scratch, options.memory_budget / 4, cancel);
  if (!drawing.levels.empty())
    drawing.box = cut_tiles(shown, drawing, options.memory_budget / 4, store, progress);
  progress.stage("join", 0, "lines");
  store.join();
  if (store.size() == 0)
    fail_without_lines(drawing, all);
  if (format.needs_paper || options.paper.scale)
    drawing.paper = paper_for(drawing.box, asked.unit, options.paper);
  if (format.open == geojson_writer && !has_place_on_globe(reader.manifest())) {
    progress.warn(
        "the hierarchy has no place on the globe, so the GeoJSON has the model's own "
        "coordinates: programs take them for longitudes and latitudes");
  }
  const Written written = write_lines(format, drawing, store, *output.file(), progress);
  if (written.lines == 0)  // all of them were points
    fail_without_lines(drawing, all);
  output.publish();
  return text_of(options, drawing, cut.name, written);
}

}  // namespace meshhier::drawing
