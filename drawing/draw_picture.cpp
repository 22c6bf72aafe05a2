#include "drawing/draw_picture.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "drawing/cut_segments.h"
#include "drawing/line_widths.h"
#include "drawing/picture_bands.h"
#include "drawing/stroke_font.h"
#include "drawing/strokes.h"
#include "execution/parallel.h"
#include "execution/size_text.h"
#include "export/byte_stream.h"
#include "export/clip_part.h"
#include "export/drawn_cut.h"
#include "export/named_cut.h"
#include "export/plan_part.h"
#include "export/plan_windows.h"
#include "export/raster_detail.h"
#include "hierarchy/attribute_rules.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::drawing {
namespace {

using exporting::DrawnCut;
using exporting::PixelGrid;
using storage::HierarchyReader;

constexpr double kInch = 25.4;
constexpr double kLetterWidth = 0.2;  // millimetres
constexpr std::array<std::uint8_t, 3> kBlack{0, 0, 0}, kBrown{0x84, 0x53, 0x2b},
    kGrey{0x80, 0x80, 0x80};

/// All that drawing needs, the same for all windows.
struct Picture {
  DrawnCut shown;
  const DrawingOptions& options;
  exporting::PlanView view;
  CutLevels levels;
  std::optional<exporting::Region> kept;  ///< what the cut leaves; none: all
  Paper paper;

  double pixels_of(double mm) const { return mm * options.dots_per_inch / kInch; }
  double width_of(const CutLevel& level) const {
    return pixels_of(!options.contours ? kSectionWidth
                     : level.is_index  ? kIndexWidth
                                       : kContourWidth);
  }
};

// ---- what there is to draw ----------------------------------------------------------------------

/// Returns what lies at most at that height above the sheet.
exporting::Region region_below(const exporting::MapFrame& view, double height) {
  const Vec3d normal = view.rows[2];
  const double offset = height - view.shift.z - dot(normal, view.origin);
  exporting::Region region;
  region.box.emplace(std::vector<HalfSpace>{{normal, offset}});
  return region;
}

std::optional<exporting::Region> region_kept(const Asked& asked) {
  if (asked.sheet.plane)
    return region_below(asked.sheet.view, *asked.sheet.plane);
  if (asked.cut_heights.empty())
    return std::nullopt;
  return region_below(asked.sheet.view, *std::ranges::max_element(asked.cut_heights));
}

PixelGrid grid_of(const Paper& paper, double dots_per_inch) {
  const double pixels_per_mm = dots_per_inch / kInch;
  const auto side = [&](double mm) { return std::max(1.0, std::ceil(mm * pixels_per_mm - 0.01)); };
  const double width = side(paper.width), height = side(paper.height);
  const double most = std::max(width, height);
  if (!(most <= kMostPictureSide)) {
    const double times = most / kMostPictureSide;
    throw Error(ErrorCode::usage,
                fmt::format("the picture would have {:.0f} x {:.0f} pixels, and a side has at most "
                            "{}; give --dpi {:.0f} or fewer, --scale {} or smaller, or a "
                            "--box",
                            width, height, kMostPictureSide, std::floor(dots_per_inch / times),
                            scale_text(least_round_length(paper.scale * times))));
  }
  return {paper.left - paper.margin / paper.mm_per_unit,
          paper.top + paper.margin / paper.mm_per_unit, 1 / (paper.mm_per_unit * pixels_per_mm),
          static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

exporting::NamedCut chosen_pixels(storage::FileSystem& files, const HierarchyReader& reader,
                                  const DrawingOptions& options, const exporting::PlanView& view) {
  if (options.selection)
    return *exporting::cut_of(files, reader, *options.selection);
  return exporting::cut_for_pixels(reader, view.frame, view.grid.size,
                                   exporting::VertexUse::picture);
}

// ---- windows ------------------------------------------------------------------------------------

/// Strokes of a window, by colour.
struct WindowStrokes {
  explicit WindowStrokes(const render::PlanWindow& window)
      : grid(window), lines(window), marks(window) {}
  StrokeMask grid, lines, marks;
};

void draw_segments(const Picture& picture, const exporting::CutPart& part, StrokeMask& lines) {
  if (picture.levels.empty())
    return;
  const SlicedPart sliced(part, picture.view.frame);
  const auto pixel_of = [&](const PassedEdge& edge, double height) {
    const Vec3d place = picture.view.frame.of_input(sliced.point_at(edge, height));
    const Vec3d at = picture.view.grid.on_grid(place);
    return exporting::PlanPoint{at.x, at.y};
  };
  sliced.for_each_segment(picture.levels, [&](std::uint32_t i, const PassedEdge& down,
                                              const PassedEdge& up) {
    const CutLevel& level = picture.levels[i];
    lines.draw(pixel_of(down, level.height), pixel_of(up, level.height), picture.width_of(level));
  });
}

void draw_marks(const Picture& picture, WindowStrokes& strokes) {
  const auto pixel_of = [&](exporting::PlanPoint mm) {
    return exporting::PlanPoint{picture.pixels_of(mm.x), picture.pixels_of(mm.y)};
  };
  const auto draw = [&](const std::vector<PaperLine>& lines, StrokeMask& mask) {
    for (const PaperLine& line : lines)
      mask.draw(pixel_of(line.from), pixel_of(line.to), picture.pixels_of(line.width));
  };
  draw(picture.paper.marks.grid, strokes.grid);
  draw(picture.paper.marks.bar, strokes.marks);
  for (const PaperText& text : picture.paper.marks.texts) {
    const double length = kTextHeight * kLetterAdvance * static_cast<double>(text.text.size());
    const double left = text.at.x - length * static_cast<double>(text.anchor) / 2;
    for_each_stroke(text.text, [&](exporting::PlanPoint from, exporting::PlanPoint to) {
      const auto at = [&](exporting::PlanPoint p) {
        return pixel_of({left + kTextHeight * p.x, text.at.y + kTextHeight * p.y});
      };
      strokes.marks.draw(at(from), at(to), picture.pixels_of(kLetterWidth));
    });
  }
}

void lay_on_white(std::span<std::uint8_t> pixels) {
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    if (pixels[i + 3] == 0)
      std::fill_n(&pixels[i], 4, std::uint8_t{255});
  }
}

struct DrawnWindow {
  std::vector<std::uint8_t> pixels;
  std::uint64_t covered = 0;  ///< pixels with something of the model
};

DrawnWindow draw_window(const Picture& picture, const exporting::PlannedWindow& planned,
                        exporting::CutParts& parts, execution::Progress& progress) {
  render::PlanRaster raster(planned.window, true);
  WindowStrokes strokes(planned.window);
  const AttributeRules rules(picture.view.layout);
  for (const std::uint32_t tile : planned.tiles) {
    exporting::CutPart part = picture.shown.load(parts, tile);
    draw_segments(picture, part, strokes.lines);
    if (picture.kept)
      part = exporting::clip_part(part, rules, *picture.kept, exporting::Clipping::at_border);
    raster.draw(exporting::plan_mesh(picture.view, std::move(part),
                                     "the picture of tile " + to_text(picture.shown.cut[tile])));
    progress.advance(1);
  }
  draw_marks(picture, strokes);
  DrawnWindow drawn{{raster.colours().begin(), raster.colours().end()}, 0};
  for (std::size_t i = 3; i < drawn.pixels.size(); i += 4)
    drawn.covered += drawn.pixels[i] > 0 ? 1 : 0;
  if (!picture.options.is_transparent)
    lay_on_white(drawn.pixels);
  strokes.grid.lay_on(drawn.pixels, kGrey, 0.7);
  strokes.lines.lay_on(drawn.pixels, picture.options.contours ? kBrown : kBlack);
  strokes.marks.lay_on(drawn.pixels, kBlack);
  return drawn;
}

/// Returns the boxes of tiles, wider by half a line, without those that the cut takes away.
std::vector<BoundsD> drawn_boxes(const Picture& picture, exporting::Benches& benches,
                                 execution::Progress& progress) {
  std::vector<BoundsD> boxes = exporting::boxes_of(picture.shown, benches, progress);
  const double half = picture.levels.empty()
                          ? 0
                          : kSectionWidth / picture.paper.mm_per_unit / picture.view.frame.scale();
  for (BoundsD& box : boxes) {
    if (box.empty())
      continue;
    if (picture.kept && !picture.kept->may_meet(box))
      box = {};
    else
      box = {box.min - Vec3d{half, half, half}, box.max + Vec3d{half, half, half}};
  }
  return boxes;
}

images::WrittenImage written_image(const Picture& picture) {
  constexpr double kMetre = 1000;
  return {.format = ImageFormat::png,
          .width = picture.view.grid.width,
          .height = picture.view.grid.height,
          .channels = picture.options.is_transparent ? 4U : 3U,
          .dots_per_metre = static_cast<std::uint32_t>(
              std::round(picture.options.dots_per_inch * kMetre / kInch))};
}

exporting::WindowPlan windows_in_memory(const Picture& picture) {
  std::uint64_t tile_bytes = 0;
  const HierarchyReader& reader = picture.shown.reader;
  for (const NodeId node : picture.shown.cut.nodes()) {
    const auto channels = static_cast<std::size_t>(picture.view.layout.channels());
    tile_bytes = std::max(tile_bytes, exporting::drawn_bytes(reader.record(node), channels, true));
  }
  const std::uint64_t budget = picture.options.memory_budget;
  exporting::WindowPlan plan = exporting::plan_windows(picture.view.grid, tile_bytes, budget);
  const images::WrittenImage image = written_image(picture);
  const auto band = [&](std::uint32_t side) { return PictureBands::band_bytes(image, side); };
  while (band(plan.side) > budget / 4 && plan.side % 2 == 0 && plan.side > 64)
    plan.side /= 2;
  if (band(plan.side) > budget / 4) {
    throw Error(
        ErrorCode::budget,
        fmt::format("a picture of {} x {} pixels needs --memory-budget {} or more", image.width,
                    image.height, execution::rounded_size_text(4 * band(plan.side))));
  }
  return plan;
}

/// What was drawn, for people.
struct Account {
  std::uint64_t covered = 0;
  std::size_t tiles = 0;
};

Account draw_windows(const Picture& picture, storage::File& file, execution::Progress& progress) {
  const exporting::WindowPlan plan = windows_in_memory(picture);
  exporting::Benches benches(picture.shown, plan.in_flight, picture.options.memory_budget / 8);
  const std::vector<BoundsD> boxes = drawn_boxes(picture, benches, progress);
  const std::vector<exporting::PlannedWindow> windows =
      exporting::windows_over(picture.view.frame, picture.view.grid, plan.side, boxes);
  std::uint64_t steps = 0;
  for (const exporting::PlannedWindow& window : windows)
    steps += window.tiles.size();
  progress.stage("draw", steps, "tiles");
  exporting::ByteStream out(file);
  PictureBands bands(written_image(picture), plan.side,
                     [&](std::span<const std::byte> bytes) { out.put(bytes); });
  Account account{0, boxes.size() - static_cast<std::size_t>(std::ranges::count(boxes, BoundsD{}))};
  execution::ordered_for(
      windows.size(), benches.size(), picture.shown.cancel,
      [&](std::size_t i) { return draw_window(picture, windows[i], benches.of(i), progress); },
      [&](std::size_t i, const DrawnWindow& drawn) {
        account.covered += drawn.covered;
        bands.put(windows[i].window, drawn.pixels);
      });
  bands.finish();
  out.flush();
  return account;
}

// ---- the files ----------------------------------------------------------------------------------

/// Six lines: a pixel's sides and turns, and the middle of the first pixel.
std::string world_file_text(const PixelGrid& grid) {
  return fmt::format("{}\n0\n0\n{}\n{}\n{}\n", grid.size, -grid.size, grid.left + grid.size / 2,
                     grid.top - grid.size / 2);
}

std::filesystem::path world_file_path(const std::filesystem::path& picture) {
  std::filesystem::path path = picture;
  return path.replace_extension(".pgw");
}

std::string text_of(const Picture& picture, const std::string& cut, const Account& account) {
  const PixelGrid& grid = picture.view.grid;
  const std::string& map = picture.view.frame.name;
  return fmt::format(
      "{}: {}, {:.0f} x {:.0f} mm, {} x {} pixels at {:.6g} dots an inch; {}, {}; {}",
      picture.options.output.string(), scale_text(picture.paper.scale), picture.paper.width,
      picture.paper.height, grid.width, grid.height, picture.options.dots_per_inch, cut,
      counted(account.tiles, "tiles"),
      map.empty() ? "on no map, in the model's coordinates" : "on " + map);
}

/// The picture's file, and the world file beside it if one is asked for.
class PictureFiles {
 public:
  /// Throws Error(usage | exists | io) if they cannot be written.
  PictureFiles(storage::FileSystem& files, const std::filesystem::path& hierarchy,
               const DrawingOptions& options, const execution::CancelToken& cancel) {
    const bool is_stream = storage::is_standard_output(files, options.output);
    if (is_stream && options.has_world_file)
      throw Error(ErrorCode::usage, "--world-file: standard output takes one file");
    if (!is_stream)
      storage::require_outside(files, options.output);
    const auto open = [&](std::optional<storage::OutputFile>& file,
                          const std::filesystem::path& path) {
      file.emplace(
          files, storage::OutputRequest{path, options.replace, {hierarchy, options.region.polygon}},
          [&cancel] { cancel.check(); });
    };
    open(picture_, options.output);
    if (options.has_world_file)
      open(world_, world_file_path(options.output));
  }

  storage::File& picture() { return *picture_->file(); }

  void publish(const PixelGrid& grid) {
    std::vector<storage::OutputFile*> made{&*picture_};
    if (world_) {
      const std::string text = world_file_text(grid);
      world_->file()->write_at(0, std::as_bytes(std::span(text)));
      made.push_back(&*world_);
    }
    storage::publish_all(made);
  }

 private:
  std::optional<storage::OutputFile> picture_, world_;
};

/// Returns the box of what is drawn; throws Error(usage) if that is nothing.
BoundsD box_of_drawing(const HierarchyReader& reader, const Asked& asked,
                       const DrawingOptions& options,
                       const std::optional<exporting::Region>& region,
                       const std::optional<exporting::Region>& kept) {
  const BoundsD box = exporting::drawn_box(reader, asked.sheet.view, options.region, region,
                                           kept ? &*kept->box : nullptr);
  if (box.empty() && kept)
    throw Error(ErrorCode::usage, "nothing lies behind the cut: all would be taken away");
  if (box.empty())
    exporting::fail_empty(reader, options.region);
  return box;
}

}  // namespace

std::string draw_picture(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                         const DrawingOptions& options, execution::Progress& progress,
                         const execution::CancelToken& cancel) {
  PictureFiles made(files, hierarchy, options, cancel);
  const storage::HierarchyFiles place(files, hierarchy);
  const HierarchyReader reader(place.files(), hierarchy);
  exporting::require_surface(reader, "a drawing");

  const Asked asked = asked_of(reader.manifest(), options);
  std::optional<exporting::Region> region;
  if (options.region.is_any())
    region = exporting::region_of(files, reader, options.region, cancel);
  std::optional<exporting::Region> kept = region_kept(asked);
  const BoundsD box = box_of_drawing(reader, asked, options, region, kept);
  Paper paper = paper_for(box, asked.unit, options.paper);
  const exporting::PlanView view{.frame = asked.sheet.view,
                                 .grid = grid_of(paper, options.dots_per_inch),
                                 .layout = reader.tile_format().attributes,
                                 .has_colours = true,
                                 .is_soft = !options.contours};
  exporting::NamedCut cut = chosen_pixels(files, reader, options, view);
  const Picture picture{{reader, std::move(cut.cut), std::move(region), cancel},
                        options,
                        view,
                        levels_of(asked, box.min.z, box.max.z),
                        std::move(kept),
                        std::move(paper)};
  const Account account = draw_windows(picture, made.picture(), progress);
  if (account.covered == 0)
    throw Error(ErrorCode::usage,
                "nothing is seen: the surface covers the middle of no pixel; give a larger scale "
                "or another view");
  made.publish(view.grid);
  return text_of(picture, cut.name, account);
}

}  // namespace meshhier::drawing
