#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "app/written_file.h"
#include "base/error.h"
#include "base/number_text.h"
#include "inspection/preview.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {
namespace {

using inspection::PreviewOptions;

struct PreviewArguments {
  std::string hierarchy;
  WebOptions web;
  std::string output;
  PreviewOptions options;
  std::optional<Level> level;
  std::optional<ImageFormat> format;
  inspection::AttributeColours attribute;
  std::string property;  ///< of objects
};

constexpr std::array<std::pair<std::string_view, Standpoint>, 7> kViews{
    {{"front", {0, 0}},
     {"right", {90, 0}},
     {"back", {180, 0}},
     {"left", {270, 0}},
     {"top", {0, 90}},
     {"bottom", {0, -90}},
     {"iso", {45, 35.26438968}}}};

/// Returns the parts before and behind the first separator.
std::pair<std::string_view, std::string_view> halves(std::string_view text, char separator) {
  const std::size_t at = std::min(text.find(separator), text.size());
  return {text.substr(0, at), text.substr(std::min(at + 1, text.size()))};
}

std::optional<Standpoint> parse_view(std::string_view text) {
  for (const auto& [name, standpoint] : kViews) {
    if (text == name)
      return standpoint;
  }
  const auto [around, above] = halves(text, ',');
  const auto azimuth = parse_number<double>(around), elevation = parse_number<double>(above);
  const bool is_there = azimuth && elevation && *azimuth >= -360 && *azimuth <= 360 &&
                        *elevation >= -90 && *elevation <= 90;
  return is_there ? std::optional(Standpoint{*azimuth, *elevation}) : std::nullopt;
}

bool parse_size(std::string_view text, PreviewOptions& options) {
  const auto [across, down] = halves(text, 'x');
  const auto width = parse_number<std::uint32_t>(across),
             height = parse_number<std::uint32_t>(down);
  const auto fits = [](const std::optional<std::uint32_t>& side) {
    return side && *side >= 1 && *side <= inspection::kMostPreviewPixels;
  };
  if (!fits(width) || !fits(height))
    return false;
  options.width = *width;
  options.height = *height;
  return true;
}

std::optional<std::array<double, 2>> parse_range(std::string_view text) {
  const auto [from, to] = halves(text, ',');
  const auto first = parse_number<double>(from), last = parse_number<double>(to);
  const bool are_there = first && last && std::isfinite(*first) && std::isfinite(*last);
  return are_there ? std::optional(std::array{*first, *last}) : std::nullopt;
}

std::optional<std::array<std::uint8_t, 3>> parse_colour(std::string_view text) {
  if (text == "white")
    return std::array<std::uint8_t, 3>{255, 255, 255};
  if (text == "black")
    return std::array<std::uint8_t, 3>{};
  std::uint32_t number = 0;
  if (text.size() != 7 || text[0] != '#')
    return std::nullopt;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, number, 16);
  if (error != std::errc{} || end != text.data() + 7)
    return std::nullopt;
  return std::array<std::uint8_t, 3>{static_cast<std::uint8_t>(number >> 16),
                                     static_cast<std::uint8_t>(number >> 8),
                                     static_cast<std::uint8_t>(number)};
}

/// Whether a picture of a hierarchy, whose ground may be transparent, can have the format.
bool is_shown(const ImageFormatRow& row) {
  return row.has_alpha && row.in_browsers;
}

std::optional<ImageFormat> format_named(std::string_view name) {
  const auto* const found = std::ranges::find_if(
      kImageFormats, [&](const ImageFormatRow& row) { return is_shown(row) && row.name == name; });
  return found == kImageFormats.end() ? std::nullopt : std::optional(found->value);
}

/// Returns their names with something before each and between two: ".png or .webp".
std::string all_formats(std::string_view before, std::string_view between) {
  std::string text;
  for (const ImageFormatRow& row : kImageFormats) {
    if (is_shown(row))
      text += fmt::format("{}{}{}", text.empty() ? "" : between, before, row.name);
  }
  return text;
}

/// Returns the format that is given, else that of the ending of the output's name.
ImageFormat format_of(const PreviewArguments& arguments) {
  if (arguments.format)
    return *arguments.format;
  const std::string ending = storage::lower_extension(arguments.output);
  const auto format = format_named(ending.empty() ? "" : std::string_view(ending).substr(1));
  if (!format) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: expected a name that ends in {}, or {}", arguments.output,
                            all_formats(".", " or "), all_formats("--format ", " or ")));
  }
  return *format;
}

/// Returns the options as they were meant together. Throws Error(usage) if they do not go together.
PreviewOptions checked_options(const PreviewArguments& arguments) {
  PreviewOptions options = arguments.options;
  options.output = arguments.output;
  options.format = format_of(arguments);
  if (arguments.level)
    options.selection = *arguments.level;
  const inspection::AttributeColours& attribute = arguments.attribute;
  if (!attribute.attribute.empty())
    options.attribute = attribute;
  else if (!arguments.property.empty())
    options.objects = {arguments.property, attribute.ramp, attribute.range};
  else if (attribute.ramp || attribute.range)
    throw Error(ErrorCode::usage, "--ramp and --range need --attribute or --colour-by");
  if (!options.region.crs.empty())
    require_region(options.region, "--crs");
  return options;
}

int run_preview(const PreviewArguments& arguments, execution::ProgressMode mode,
                Environment& environment) {
  const PreviewOptions options = checked_options(arguments);
  return write_file({arguments.hierarchy, arguments.web, {arguments.output}}, mode, environment,
                    [&](const HierarchyPlace& place, execution::Progress& progress) {
                      return inspection::make_picture(place.files(), place.path(), options,
                                                      progress, environment.cancel);
                    });
}

void add_what(CLI::App& command, PreviewArguments& arguments) {
  CLI::App* what = add_group(command, "What", "At most one of these");
  PreviewOptions& options = arguments.options;
  add_integer_option(
      *what, {"--level", "All tiles of this level; the root is 0", 0, kDeepestLevel},
      [&arguments](std::uint64_t level) { arguments.level = static_cast<Level>(level); });
  add_text_option(*what, {"--cut", "The cut that this file lists, as for export", "FILE", "a file"},
                  [&options](const std::string& text) {
                    options.selection = std::filesystem::path(text);
                    return !text.empty();
                  });
  add_error_option(
      *what, [&options](double error) { options.selection = exporting::LargestError{error}; });
  what->require_option(0, 1);
}

void add_look(CLI::App& command, PreviewArguments& arguments) {
  PreviewOptions& options = arguments.options;
  add_text_option(command,
                  {"--size", "Pixels of the picture [1600x1000]", "WIDTHxHEIGHT",
                   "WIDTHxHEIGHT, 1 to 8192 each"},
                  [&options](const std::string& text) { return parse_size(text, options); });
  add_text_option(command,
                  {"--view",
                   "front, back, left, right, top, bottom, iso, or degrees from the front to the "
                   "right and above the equator; if not given, the hierarchy's first view",
                   "NAME|AZ,EL", "front, back, left, right, top, bottom, iso, or AZ,EL in degrees"},
                  [&options](const std::string& text) {
                    options.view = parse_view(text);
                    return options.view.has_value();
                  });
  add_name_option(
      command,
      {"--link", "Draws what the page shows from this link: all of it, or from # on", "LINK"},
      options.link);
  add_text_option(command,
                  {"--up",
                   "Which axis of the input points up; if not given, as the "
                   "hierarchy says",
                   "y|z", "y or z"},
                  [&options](const std::string& text) {
                    options.up = text == "z" ? UpAxis::z : UpAxis::y;
                    return text == "y" || text == "z";
                  });
  add_text_option(
      command,
      {"--background", "white, black, or #rrggbb; if not given, the ground is transparent",
       "COLOUR", "white, black, or #rrggbb"},
      [&options](const std::string& text) {
        options.background = parse_colour(text);
        return options.background.has_value();
      });
  add_text_option(command,
                  {"--format", "What to write, whatever the name: -o - needs it",
                   all_formats("", "|"), all_formats("", " or ")},
                  [&arguments](const std::string& text) {
                    arguments.format = format_named(text);
                    return arguments.format.has_value();
                  });
}

void add_colours(CLI::App& command, PreviewArguments& arguments) {
  inspection::AttributeColours& colours = arguments.attribute;
  CLI::Option* attribute = command.add_option("--attribute", colours.attribute,
                                              "Colours by this attribute; inspect lists them");
  attribute->type_name("NAME");
  add_name_option(
      command,
      {"--colour-by",
       "Colours each object by this property, or by name, area or triangles; tells what they mean",
       "PROPERTY"},
      arguments.property)
      ->excludes(attribute);
  add_text_option(command,
                  {"--ramp", "Its colours; if not given, coolwarm for signed values, else viridis",
                   "viridis|cividis|turbo|coolwarm", "viridis, cividis, turbo or coolwarm"},
                  [&colours](const std::string& text) {
                    colours.ramp = render::ramp_named(text);
                    return colours.ramp.has_value();
                  });
  add_text_option(command,
                  {"--range", "Values at the ends of the ramp; if not given, all", "FROM,TO",
                   "two numbers, FROM,TO"},
                  [&colours](const std::string& text) {
                    colours.range = parse_range(text);
                    return colours.range.has_value();
                  });
}

/// Options of drawings at a scale, which another command makes: they are answered with it.
void add_hints_at_drawings(CLI::App& command) {
  for (const char* name : {"--plan", "--elevation", "--section", "--plane", "--cut-height",
                           "--contours", "--scale", "--dpi"}) {
    command
        .add_option_function<std::vector<std::string>>(
            name,
            [name](const std::vector<std::string>&) {
              throw CLI::ValidationError(
                  name,
                  "drawings at a scale are made by \"meshhier draw HIERARCHY --plan --scale 1:50 "
                  "--dpi 300 -o plan.png\"; \"meshhier draw --help\" tells more");
            })
        ->expected(0, 2)
        ->group("");  // not listed
  }
}

constexpr const char* kPreviewFooter =
    R"(Without --level, --cut or --error the tiles are at most a quarter of a pixel off. They are drawn
one by one, so memory holds the picture and one tile. A hierarchy that has a view (meshhier view) is
drawn with it; options take the place of what it says. The front is where +z is, or -y if z points
up; --view 90,20 looks at the right side from 20 degrees above it.

Plans, elevations and sections at a scale are made by "meshhier draw".

Every hierarchy has a small picture already, preview.webp, unless its config says "preview": false.

Examples:
  meshhier preview david.hier -o david.png
  meshhier preview david.hier --view front --size 800x1200 --background white -o david.webp
  meshhier preview town.3tz --up z --view top --error 0.5 -o map.png
  meshhier preview scan.hier --attribute quality --ramp turbo --range 0,1 -o quality.png
  meshhier preview town.3tz --colour-by storeys --where "built < '1945-01-01'" -o storeys.png
  meshhier preview david.hier --link '#david.hier&0,1,3,0,1,0&light=raking' -o letters.png
  meshhier preview town.3tz --polygon parcel.geojson --view top -o parcel.png
  meshhier preview david.hier --level 0 --size 640x480 --format png -o - | display
)";

}  // namespace

void add_preview_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<PreviewArguments>();
  CLI::App* command =
      parser.add_subcommand("preview", "Draw a picture of a hierarchy, a level or a cut of it");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);
  add_what(*command, *arguments);
  add_region_options(*command, arguments->options.region);
  add_look(*command, *arguments);
  add_colours(*command, *arguments);
  add_file_output_options(*command, "The picture: " + all_formats(".", " or "), arguments->output,
                          arguments->options.replace);
  add_memory_budget_option(*command, arguments->options.memory_budget);
  add_progress_option(*command, invocation.progress);
  add_hints_at_drawings(*command);
  command->footer(kPreviewFooter);
  run_if_chosen(*command, invocation, arguments, run_preview);
}

}  // namespace meshhier::app
