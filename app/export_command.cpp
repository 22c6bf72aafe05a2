#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "export/export.h"
#include "export/piece_mesh.h"
#include "pipeline/build.h"

#include <memory>
#include <optional>
#include <ostream>
#include <string>

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
  std::string output;
  bool force = false;
  std::uint64_t memory_budget = exporting::ExportOptions{}.memory_budget;
};

/// Requires that exactly one of them was given.
exporting::ExportSelection selection(const ExportArguments& arguments) {
  if (arguments.level)
    return *arguments.level;
  if (arguments.node)
    return *arguments.node;
  if (!arguments.cut.empty())
    return std::filesystem::path(arguments.cut);
  if (arguments.error)
    return exporting::LargestError{*arguments.error};
  return exporting::OutlineSelection{};
}

/// Builds a hierarchy of the piece and returns a text for people.
std::string make_hierarchy(const HierarchyPlace& place, const exporting::ExportOptions& options,
                           execution::Progress& progress, Environment& environment) {
  const exporting::PieceMesh piece(place.files(), place.path(), options, environment.files,
                                   progress, environment.cancel);
  pipeline::BuildOptions build{.force = options.replace, .restart = true};
  build.leaves_work = false;  // nobody could go on with it
  const pipeline::BuildReport report = pipeline::build_hierarchy(
      piece.config(), build, {environment.files, progress, environment.cancel});
  return report.text + "its simplified levels are new: a piece has another tree than the whole";
}

int run_export(const ExportArguments& arguments, execution::ProgressMode mode,
               Environment& environment) {
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  const exporting::ExportOptions options{selection(arguments),    arguments.output,
                                         arguments.memory_budget, arguments.force,
                                         arguments.region,        arguments.clip};
  if (arguments.clip)
    require_region(arguments.region, "--clip");
  if (!arguments.region.crs.empty())
    require_region(arguments.region, "--crs");
  require_no_terminal(environment, arguments.output);
  std::ostream& account = account_stream(environment, arguments.output);
  const HierarchyPlace place(environment, arguments.hierarchy, arguments.web);
  const std::string line = exporting::is_hierarchy_name(arguments.output)
                               ? make_hierarchy(place, options, *progress, environment)
                               : exporting::export_mesh(place.files(), place.path(), options,
                                                        *progress, environment.cancel);
  progress->finish(arguments.output);
  account << line << '\n' << place.account();
  return 0;
}

constexpr const char* kExportFooter =
    R"(A cut file lists nodes, one LEVEL/INDEX a line (# begins a comment), or as a JSON list; together
they must cover every partition once. The pieces are joined without seams. A NAME.hier or NAME.3tz is
a hierarchy of its own, built as the whole was: its simplified levels are made anew.

Examples:
  meshhier export david.hier --level 0 -o whole.ply
  meshhier export david.hier --node 3/5 -o sector.ply
  meshhier export david.hier --cut view.txt -o view.ply
  meshhier export david.hier --outline -o outline.ply
  meshhier export church.hier --level 3 -o church.glb
  meshhier export david.hier --level 2 -o - | gzip > level2.ply.gz
  meshhier export town.hier --error 0.05 --box 0,0,-10 200,100,90 --clip -o quarter.glb
  meshhier export town.hier --level 6 --polygon parcel.geojson --crs EPSG:4326 --clip -o parcel.ply
  meshhier export town.3tz --error 0 --box 0,0,-10 200,100,90 -o quarter.3tz
  meshhier export https://example.org/town.3tz --level 4 -o town.ply
)";

}  // namespace

void add_export_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command =
      parser.add_subcommand("export", "Write part of a hierarchy as a PLY, GLB or OBJ file");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);

  CLI::App* what = add_group(*command, "What", "Exactly one of these");
  add_place_options(*what, arguments->level, arguments->node);
  what->add_option("--cut", arguments->cut, "The cut that this file lists")
      ->type_name("FILE")
      ->check([](const std::string& text) {
        return text.empty() ? "expected a file, found nothing" : "";
      });
  add_error_option(*what, [arguments](double error) { arguments->error = error; });
  what->add_flag("--outline", arguments->outline, "The shape-outline, as edges");
  what->require_option(1);
  add_region_options(*command, arguments->region);
  command->add_flag("--clip", arguments->clip, "Cut triangles where box or polygon end");

  add_file_output_options(
      *command, "What to write: .glb or .obj, with textures, .hier or .3tz, or else a PLY",
      arguments->output, arguments->force);
  add_memory_budget_option(*command, arguments->memory_budget);
  add_progress_option(*command, invocation.progress);
  command->footer(kExportFooter);
  command->callback([arguments, &invocation] {
    invocation.run = [arguments, &invocation](Environment& environment) {
      return run_export(*arguments, invocation.progress, environment);
    };
  });
}

}  // namespace meshhier::app
