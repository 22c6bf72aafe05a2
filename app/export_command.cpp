#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "app/written_file.h"
#include "base/number_text.h"
#include "export/export.h"
#include "export/orthophoto.h"
#include "export/piece_mesh.h"
#include "pipeline/build.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

struct ExportArguments {
  std::string hierarchy;
  WebOptions web;
  std::optional<Level> level;
  std::optional<NodeId> node;
  std::string cut;
  std::optional<double> error;
  bool outline = false;
  exporting::RegionRequest region;
  bool clip = false;
  std::optional<double> pixel;
  std::optional<exporting::PlanPoint> corner;
  std::string heights;
  std::string output;
  bool force = false;
  std::uint64_t memory_budget = exporting::ExportOptions{}.memory_budget;
};

/// Whether a raster is asked for, and not a mesh.
bool is_raster(const ExportArguments& arguments) {
  return !arguments.heights.empty() || arguments.pixel || arguments.corner ||
         exporting::is_raster_name(arguments.output);
}

/// Requires that at most one of them was given. Of a piece the original is meant without one.
std::optional<exporting::ExportSelection> selection(const ExportArguments& arguments) {
  if (arguments.level)
    return *arguments.level;
  if (arguments.node)
    return *arguments.node;
  if (!arguments.cut.empty())
    return std::filesystem::path(arguments.cut);
  if (arguments.error)
    return exporting::LargestError{*arguments.error};
  if (arguments.outline)
    return exporting::OutlineSelection{};
  if (arguments.region.is_any() && !is_raster(arguments))
    return exporting::LargestError{0};
  return std::nullopt;
}

/// Throws CLI::RequiredError.
void require_complete(const ExportArguments& arguments) {
  if (arguments.output.empty() && arguments.heights.empty())
    throw CLI::RequiredError("--output");
  if (!is_raster(arguments) && !selection(arguments))
    throw CLI::RequiredError(
        "say what to export, by --error (0: the original), --level, --node, --cut or --outline, or "
        "a piece by --box, --polygon, --object or --where",
        CLI::ExitCodes::RequiredError);
}

/// Builds a hierarchy of the piece and returns a text for people.
std::string make_hierarchy(const HierarchyPlace& place, const exporting::ExportOptions& options,
                           execution::Progress& progress, Environment& environment) {
  const exporting::PieceMesh piece(place.files(), place.path(), options, environment.files,
                                   progress, environment.cancel);
  pipeline::BuildOptions build{.force = options.replace, .restart = pipeline::Restart::always};
  build.leaves_work = false;  // nobody could go on with it
  const pipeline::BuildReport report = pipeline::build_hierarchy(
      piece.config(), build, {environment.files, progress, environment.cancel});
  return report.text + "its simplified levels are new: a piece has another tree than the whole";
}

/// Writes a mesh or a hierarchy and returns a text for people.
std::string make_mesh(const HierarchyPlace& place, const ExportArguments& arguments,
                      execution::Progress& progress, Environment& environment) {
  const exporting::ExportOptions options{selection(arguments).value(),
                                         arguments.output,
                                         arguments.memory_budget,
                                         arguments.force,
                                         arguments.region,
                                         arguments.clip};
  return exporting::is_hierarchy_name(arguments.output)
             ? make_hierarchy(place, options, progress, environment)
             : exporting::export_mesh(place.files(), place.path(), options, progress,
                                      environment.cancel);
}

std::string make_rasters(const HierarchyPlace& place, const ExportArguments& arguments,
                         execution::Progress& progress, Environment& environment) {
  const exporting::RasterOptions options{
      .picture = arguments.output,
      .heights = arguments.heights,
      .pixel = arguments.pixel,
      .corner = arguments.corner.value_or(exporting::PlanPoint{}),
      .selection = selection(arguments),
      .memory_budget = arguments.memory_budget,
      .replace = arguments.force,
      .region = arguments.region};
  return exporting::export_rasters(place.files(), place.path(), options, progress,
                                   environment.cancel);
}

int run_export(const ExportArguments& arguments, execution::ProgressMode mode,
               Environment& environment) {
  if (arguments.clip)
    require_region(arguments.region, "--clip");
  if (!arguments.region.crs.empty())
    require_region(arguments.region, "--crs");
  return write_file(
      {arguments.hierarchy, arguments.web, {arguments.output, arguments.heights}}, mode,
      environment, [&](const HierarchyPlace& place, execution::Progress& progress) {
        return is_raster(arguments) ? make_rasters(place, arguments, progress, environment)
                                    : make_mesh(place, arguments, progress, environment);
      });
}

constexpr const char* kExportFooter =
    R"(A cut file lists nodes, one LEVEL/INDEX a line (# begins a comment), or as a JSON list; together
they must cover every partition once. The pieces are joined without seams. A NAME.hier or NAME.3tz is
a hierarchy of its own, built as the whole was: its simplified levels are made anew.

A NAME.tif is an orthophoto, --dsm FILE the heights of the highest surface (float, -9999 where there
is none): GeoTIFFs of the model seen from above, on its map, on the globe's plane where it stands, or in
its own coordinates. Both may be made in one run, and end where box or polygon do. They show tiles
that are at most half a pixel off, unless --level, --cut or --error asks for others; without pictures,
and for heights, vertices are as dense as pixels, too. What has neither pictures nor colours is shown
as a relief in grey.

Examples:
  meshhier export david.hier --level 0 -o whole.ply
  meshhier export david.hier --node 3/5 -o sector.ply
  meshhier export david.hier --cut view.txt -o view.ply
  meshhier export david.hier --outline -o outline.ply
  meshhier export church.hier --level 3 -o church.glb
  meshhier export david.hier --level 2 -o - | gzip > level2.ply.gz
  meshhier export town.hier --error 0.05 --box 0,0,-10 200,100,90 --clip -o quarter.glb
  meshhier export town.hier --level 6 --polygon parcel.geojson --crs EPSG:4326 --clip -o parcel.ply
  meshhier export town.3tz --box 0,0,-10 200,100,90 -o quarter.3tz
  meshhier export town.hier --object 'Main Street/' -o street.obj
  meshhier export town.hier --where "storey = 3 and owner like 'A%'" -o storey.glb
  meshhier export town.hier --gsd 0.02 -o ortho.tif --dsm dsm.tif
  meshhier export hills.hier --gsd 30 --align 15,15 --dsm heights.tif
  meshhier export https://example.org/town.3tz --level 4 -o town.ply
)";

/// Adds --gsd, --align and --dsm.
void add_raster_options(CLI::App& command, ExportArguments& arguments) {
  CLI::App* group = add_group(command, "Rasters", "The model seen from above, as GeoTIFFs");
  group
      ->add_option_function<std::string>(
          "--gsd",
          [&arguments](const std::string& text) {
            arguments.pixel = parse_number<double>(text);
            if (!arguments.pixel || !(*arguments.pixel > 0) || !std::isfinite(*arguments.pixel))
              throw CLI::ValidationError("--gsd", "expected a length above 0, found " + text);
          },
          "A pixel's side: in units of the map, metres on the globe, else units of the input; if "
          "not "
          "given, about as fine as the input")
      ->type_name("LENGTH");
  group
      ->add_option_function<std::string>(
          "--align",
          [&arguments](const std::string& text) {
            const std::size_t comma = std::min(text.find(','), text.size());
            const auto x = parse_number<double>(std::string_view(text).substr(0, comma));
            const auto y = parse_number<double>(
                std::string_view(text).substr(std::min(comma + 1, text.size())));
            if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y))
              throw CLI::ValidationError("--align", "expected two numbers, X,Y, found " + text);
            arguments.corner = exporting::PlanPoint{*x, *y};
          },
          "A place where pixels have a corner [0,0]")
      ->type_name("X,Y");
  add_name_option(*group, {"--dsm", "Write the heights of the highest surface, too"},
                  arguments.heights);
}

}  // namespace

void add_export_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = parser.add_subcommand(
      "export", "Write part of a hierarchy as a PLY, GLB or OBJ file, or as an orthophoto");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);

  CLI::App* what = add_group(*command, "What",
                             "Exactly one of these; at most one of a raster, and of a piece, which "
                             "is of the original without");
  add_place_options(*what, arguments->level, arguments->node);
  what->add_option("--cut", arguments->cut, "The cut that this file lists")
      ->type_name("FILE")
      ->check([](const std::string& text) {
        return text.empty() ? "expected a file, found nothing" : "";
      });
  add_error_option(*what, [arguments](double error) { arguments->error = error; });
  what->add_flag("--outline", arguments->outline, "The shape-outline, as edges");
  what->require_option(0, 1);
  add_region_options(*command, arguments->region);
  add_raster_options(*command, *arguments);
  command->add_flag("--clip", arguments->clip, "Cut triangles where box or polygon end");

  add_file_output_options(*command,
                          "What to write: .glb or .obj, with textures, .hier or .3tz, .tif (an "
                          "orthophoto), or else a PLY",
                          arguments->output, arguments->force, Given::not_always);
  add_memory_budget_option(*command, arguments->memory_budget);
  add_progress_option(*command, invocation.progress);
  command->footer(kExportFooter);
  command->callback([arguments, &invocation] {
    require_complete(*arguments);
    invocation.run = [arguments, &invocation](Environment& environment) {
      return run_export(*arguments, invocation.progress, environment);
    };
  });
}

}  // namespace meshhier::app
