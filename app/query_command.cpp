#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "base/error.h"
#include "base/small_letters.h"
#include "compare/selected_surface.h"
#include "query/query.h"
#include "storage/io/output_file.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>

namespace meshhier::app {
namespace {

struct QueryArguments {
  std::string hierarchy;
  WebOptions web;
  std::string points, rays;
  std::string output = storage::kStandardOutput;
  std::optional<querying::AnswerFormat> format;
  bool json = false;
  querying::QueryOptions options;
};

/// Returns the format that is asked for, else the one that the output's name asks for.
querying::AnswerFormat format_of(const QueryArguments& arguments) {
  const std::string ending =
      small_letters(std::filesystem::path(arguments.output).extension().string());
  return arguments.format.value_or(ending == ".npy" ? querying::AnswerFormat::npy
                                                    : querying::AnswerFormat::csv);
}

int run_query_command(const QueryArguments& arguments, execution::ProgressMode mode,
                      Environment& environment) {
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  querying::QueryOptions options = arguments.options;
  options.kind = arguments.rays.empty() ? querying::RowKind::points : querying::RowKind::rays;
  options.rows = arguments.rays.empty() ? arguments.points : arguments.rays;
  options.output = arguments.output;
  options.format = format_of(arguments);
  if (options.has_sides && options.kind == querying::RowKind::rays)
    throw Error(ErrorCode::usage, "--signed is about points: rays have no side");
  if (options.format == querying::AnswerFormat::npy)
    require_no_terminal(environment, options.output);
  const HierarchyPlace place(environment, arguments.hierarchy, arguments.web);
  const querying::QuerySummary summary = querying::run_query(
      place.files(), place.path(), environment.files, options, *progress, environment.cancel);
  progress->finish(arguments.output);
  account_stream(environment, options.output)
      << (arguments.json ? pretty_json(query_json(summary)) : query_text(summary));
  environment.messages << place.account();
  return 0;
}

constexpr const char* kQueryFooter =
    R"(For each point the nearest place of the surface, for each ray what it hits first, exactly: as if all
triangles were tried. Neither the hierarchy nor the points need fit into memory. Rows are in the
coordinates of the input, and so are answers, one a row, in the order of the rows:

  distance          to the surface; along the ray. inf: it hits nothing; nan: the row has no place
  x,y,z             the place on the surface
  nx,ny,nz          of rays: the normal of the triangle, by the order of its corners
  level,index       the tile, as --node of other commands has it
  triangle          its number in the tile: interior ones, then the border; -1: none
  side              with --signed: 1 outside, -1 inside, 0 not known
  object,name       if the mesh has objects: what the triangle belongs to

FILE is a text (x y z, or x y z dx dy dz a line, between blanks, commas, semicolons or tabs; a first
line may name columns), a .npy of n x 3 or n x 6 numbers, or a PLY, of whose vertices rays have the
normals as directions. "-" is standard input. A .npy that is written is a structured array.

Examples:
  meshhier query david.hier --points scanner.csv -o distances.csv
  echo 1.5 0.2 3 | meshhier query david.hier --points -
  meshhier query david.hier --points scan.ply --signed -o distances.npy
  meshhier query town.3tz --rays rays.npy -o hits.npy
  meshhier query david.hier --points p.csv --error 0.05 -o quick.csv
  meshhier query town.hier --points p.csv --where "kind = 'roof'" -o roofs.csv
  meshhier query https://example.org/david.3tz --points p.csv -o near.csv
)";

}  // namespace

void add_query_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<QueryArguments>();
  CLI::App* command = parser.add_subcommand(
      "query", "Tell of many points what is nearest, and of rays what they hit first");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);

  CLI::App* rows = add_group(*command, "Rows", "Exactly one of these");
  add_name_option(*rows, {"--points", "What is nearest to the points of FILE"}, arguments->points);
  add_name_option(*rows, {"--rays", "What the rays of FILE hit first, from either side"},
                  arguments->rays);
  rows->require_option(1);

  CLI::App* what = add_group(*command, "What", "At most one of these; else the original surface");
  add_detail_options(*what, "All tiles of this level; the root is 0", arguments->options.selection);
  add_region_options(*command, arguments->options.piece);
  command->add_flag("--signed", arguments->options.has_sides,
                    "Of points: tell the side; distances are below 0 inside");

  add_file_output_options(*command, "What to write: .npy, or else a CSV; if not given, \"-\"",
                          arguments->output, arguments->options.replace, Given::not_always);
  add_text_option(*command,
                  {"--format", "What to write, whatever the name", "csv|npy", "csv or npy"},
                  [arguments](const std::string& text) {
                    arguments->format =
                        text == "npy" ? querying::AnswerFormat::npy : querying::AnswerFormat::csv;
                    return text == "npy" || text == "csv";
                  });
  command->add_flag("--json", arguments->json, "Tell what was done for scripts");
  add_memory_budget_option(*command, arguments->options.memory_budget);
  add_progress_option(*command, invocation.progress);
  command->footer(kQueryFooter);
  run_if_chosen(*command, invocation, arguments, run_query_command);
}

}  // namespace meshhier::app
