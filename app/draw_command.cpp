#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "app/written_file.h"
#include "base/error.h"
#include "base/number_text.h"
#include "drawing/drawing.h"
#include "hierarchy/length.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::app {
namespace {

using drawing::DrawingOptions;

struct DrawArguments {
  std::string hierarchy;
  WebOptions web;
  std::string output;
  std::string format;
  DrawingOptions options;
};

/// Returns so many numbers of a text, "X,Y"; nothing if it is anything else.
std::optional<std::vector<double>> numbers_in(std::string_view text, std::size_t count) {
  auto numbers = parse_numbers(text);
  return numbers && numbers->size() == count ? numbers : std::nullopt;
}

/// Returns a number above 0.
std::optional<double> positive_in(std::string_view text) {
  const auto number = parse_finite(text);
  return number && *number > 0 ? number : std::nullopt;
}

/// Returns a length above 0.
std::optional<Length> length_in(std::string_view text) {
  const auto length = parse_length(text);
  return length && length->number > 0 ? length : std::nullopt;
}

/// Returns the heights of "1.2m,4m"; nothing if one of them is none.
std::optional<std::vector<Length>> heights_in(std::string_view text) {
  return parse_list(text, parse_length);
}

/// Returns N of "1:N", of "N", or of "2:1", which is twice as large.
std::optional<double> scale_in(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos)
    return positive_in(text);
  const auto paper = positive_in(text.substr(0, colon)),
             model = positive_in(text.substr(colon + 1));
  const bool is_scale = paper && model && std::isfinite(*model / *paper) && *model / *paper > 0;
  return is_scale ? std::optional(*model / *paper) : std::nullopt;
}

std::string format_of(const DrawArguments& arguments) {
  const std::vector<std::string> names = drawing::format_names();
  std::string format = arguments.format;
  if (format.empty()) {
    const std::string ending = storage::lower_extension(arguments.output);
    format = ending.empty() ? "" : ending.substr(1);
  }
  if (std::ranges::find(names, format) == names.end()) {
    throw Error(ErrorCode::usage, fmt::format("{}: expected a name that ends in .{}, or --format",
                                              arguments.output, fmt::join(names, ", .")));
  }
  return format;
}

int run_draw(const DrawArguments& arguments, execution::ProgressMode mode,
             Environment& environment) {
  DrawingOptions options = arguments.options;
  options.output = arguments.output;
  options.format = format_of(arguments);
  if (!options.region.crs.empty())
    require_region(options.region, "--crs");
  return write_file({arguments.hierarchy, arguments.web, {arguments.output}}, mode, environment,
                    [&](const HierarchyPlace& place, execution::Progress& progress) {
                      return drawing::draw(place.files(), place.path(), options, progress,
                                           environment.cancel);
                    });
}

/// Stores what `read` finds in the text; returns whether that is anything.
template <class Value, class Found>
bool store_found(Value& value, const Found& found) {
  if (found)
    value = *found;
  return found.has_value();
}

void add_section_option(CLI::App& view, DrawingOptions& options) {
  view.add_option_function<std::vector<std::string>>(
          "--section",
          [&options](const std::vector<std::string>& ends) {
            const auto from = numbers_in(ends[0], 2), to = numbers_in(ends[1], 2);
            if (!from || !to) {
              throw CLI::ValidationError(
                  "--section",
                  fmt::format("expected two places, X,Y X,Y, found \"{} {}\"", ends[0], ends[1]));
            }
            options.view = drawing::SectionLine{{(*from)[0], (*from)[1]}, {(*to)[0], (*to)[1]}};
          },
          "An upright section through two places seen from above; the first one is on the left")
      ->type_name("X,Y X,Y")
      ->expected(2);
}

void add_views(CLI::App& command, DrawingOptions& options) {
  CLI::App* view = add_group(command, "View", "At most one of these");
  view->add_flag_callback(
      "--plan", [&options] { options.view = drawing::PlanFromAbove{}; },
      "From above, north up, if nothing else is said");
  add_text_option(
      *view,
      {"--elevation", "From a side; the front is the south, where -y is, or +z if y points up",
       "front|right|back|left", "front, right, back or left"},
      [&options](const std::string& text) {
        const auto* const side =
            std::ranges::find(drawing::kSides, text, [](const auto& row) { return row.first; });
        if (side != drawing::kSides.end())
          options.view = side->second;
        return side != drawing::kSides.end();
      });
  add_section_option(*view, options);
  add_text_option(*view,
                  {"--plane",
                   "A section by any plane: what lies where NX x + NY y + NZ z + D is above 0 "
                   "stays; input coordinates",
                   "NX,NY,NZ,D", "four numbers, NX,NY,NZ,D"},
                  [&options](const std::string& text) {
                    const auto n = numbers_in(text, 4);
                    if (n)
                      options.view = drawing::SectionPlane{{(*n)[0], (*n)[1], (*n)[2]}, (*n)[3]};
                    return n.has_value();
                  });
  view->require_option(0, 1);
}

void add_cuts(CLI::App& command, DrawingOptions& options) {
  CLI::App* cut = add_group(command, "Cuts of a plan", "At most one of these");
  add_text_option(*cut,
                  {"--cut-height",
                   "Cuts at this height: what is above is taken away, and the lines of the cut are "
                   "drawn. Several heights give as many lines",
                   "Z,...", "heights, Z or Z,Z,..., perhaps with units"},
                  [&options](const std::string& text) {
                    return store_found(options.cut_heights, heights_in(text));
                  });
  add_text_option(
      *cut,
      {"--contours", "Contour lines at multiples of this; each fifth is an index contour",
       "INTERVAL", "a length above 0, perhaps with a unit"},
      [&options](const std::string& text) {
        return store_found(options.contours, length_in(text));
      });
  cut->require_option(0, 1);
}

void add_sheet(CLI::App& command, DrawingOptions& options) {
  CLI::App* sheet = add_group(command, "Sheet", "The paper and what is on it");
  add_text_option(*sheet,
                  {"--scale", "1:50 or 2:1; if not given, the largest round one that fits on A4",
                   "1:N", "a scale, 1:N"},
                  [&options](const std::string& text) {
                    return store_found(options.paper.scale, scale_in(text));
                  });
  add_text_option(*sheet,
                  {"--units", "The unit of the model's coordinates, if the hierarchy tells none",
                   "mm|cm|m|km|in|ft|us_ft", "mm, cm, m, km, in, ft or us_ft"},
                  [&options](const std::string& text) {
                    const auto* const row = std::ranges::find(kUnits, text, &UnitRow::name);
                    if (row != kUnits.end())
                      options.units = row->value;
                    return row != kUnits.end();
                  });
  add_text_option(*sheet,
                  {"--dpi", "Dots an inch of a picture [300]", "N", "a number from 10 to 4800"},
                  [&options](const std::string& text) {
                    const auto dots = parse_number<double>(text);
                    if (dots && *dots >= 10 && *dots <= 4800)
                      options.dots_per_inch = *dots;
                    return dots && options.dots_per_inch == *dots;
                  });
  sheet
      ->add_option_function<std::string>(
          "--grid",
          [&options](const std::string& text) {
            options.paper.has_grid = true;
            if (!text.empty() && !store_found(options.paper.grid, length_in(text)))
              throw CLI::ValidationError(
                  "--grid", "expected a length above 0, perhaps with a unit, found " + text);
          },
          "A grid of coordinates with their numbers; =LENGTH says how far apart its lines are")
      ->type_name("LENGTH")
      ->expected(0, 1);
  sheet->add_flag_callback(
      "--no-scale-bar", [&options] { options.paper.has_bar = false; },
      "Neither a scale bar nor the scale");
  sheet->add_flag("--transparent", options.is_transparent,
                  "A picture is transparent where nothing is; else white");
  sheet->add_flag("--world-file", options.has_world_file,
                  "Write the place of a plan's picture beside it, as NAME.pgw");
  sheet->add_flag(
      "--flat", options.is_flat,
      "Sections in DXF lie on the sheet, x along and y up; else in space, on the model");
}

void add_detail(CLI::App& command, DrawingOptions& options) {
  CLI::App* what = add_group(command, "Detail", "At most one of these");
  add_detail_options(*what, "All tiles of this level; the root is 0", options.selection);
}

constexpr const char* kDrawFooter =
    R"(A .png is a picture at the scale: it tells its dots an inch, so a print has that scale. It shows tiles
that are at most half a pixel off. A .svg has the lines of a cut in millimetres of paper, a .dxf in units of
the model, and a .geojson as longitudes and latitudes. Lines are those of the original triangles, unless
--level or --error asks for others; they are closed where the surface is. What lies exactly on a height
counts as above it.

Coordinates, heights and lengths are those of the map that the model lies on, else of the model, z-up.
Heights, intervals and the grid's may have a unit: 1.2m, 50cm, 10ft.

Examples:
  meshhier draw house.hier --scale 1:50 -o plan.png
  meshhier draw house.hier --cut-height 1.2m --scale 1:50 --grid=50cm -o floor.png
  meshhier draw house.hier --cut-height 1.2 -o floor.dxf
  meshhier draw house.hier --elevation front --scale 1:100 --dpi 600 -o front.png
  meshhier draw church.hier --section 0,4 20,4 --scale 1:100 -o section.svg
  meshhier draw statue.hier --units mm --plane 1,0,0,-40 --flat -o profile.dxf
  meshhier draw hills.hier --contours 10 --scale 1:25000 --grid -o contours.svg
  meshhier draw hills.hier --contours 10 -o contours.geojson
  meshhier draw town.3tz --box 0,0,-10 200,100,90 --transparent --world-file -o quarter.png
)";

}  // namespace

void add_draw_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<DrawArguments>();
  CLI::App* command = parser.add_subcommand(
      "draw", "Draw plans, elevations, sections and contour lines at a scale");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);
  add_views(*command, arguments->options);
  add_cuts(*command, arguments->options);
  add_sheet(*command, arguments->options);
  add_detail(*command, arguments->options);
  add_region_options(*command, arguments->options.region);
  const std::vector<std::string> names = drawing::format_names();
  add_text_option(
      *command,
      {"--format", "What to write, whatever the name: -o - needs it",
       fmt::format("{}", fmt::join(names, "|")), fmt::format("one of {}", fmt::join(names, ", "))},
      [arguments, names](const std::string& text) {
        arguments->format = text;
        return std::ranges::find(names, text) != names.end();
      });
  add_file_output_options(*command, fmt::format("The drawing: .{}", fmt::join(names, ", .")),
                          arguments->output, arguments->options.replace);
  add_memory_budget_option(*command, arguments->options.memory_budget);
  add_progress_option(*command, invocation.progress);
  command->footer(kDrawFooter);
  run_if_chosen(*command, invocation, arguments, run_draw);
}

}  // namespace meshhier::app
