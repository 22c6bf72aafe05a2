#include "app/command.h"
#include "app/compared_hierarchy.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "base/error.h"
#include "compare/compare.h"
#include "export/piece_mesh.h"
#include "hierarchy/length.h"
#include "hierarchy/object_row.h"
#include "pipeline/build.h"
#include "storage/io/output_file.h"
#include "storage/io/web_address.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {
namespace {

/// The exit code if a vertex is farther than the tolerance.
constexpr int kExitFarther = 1;
constexpr std::uint64_t kMostTransformBytes = 65536;

struct CompareArguments {
  std::string from, to;
  WebOptions web;
  std::string output, transform;
  bool has_no_sign = false, json = false;
  comparing::CompareOptions options;
};

/// Stores "0.5" or "0.5mm".
void store_tolerance(const std::string& text, comparing::CompareOptions& options) {
  const auto length = parse_length(text);
  if (!length || !(length->number >= 0)) {
    throw CLI::ValidationError(
        "--tolerance",
        fmt::format("expected a length of 0 or more, perhaps with one of {}, found \"{}\"",
                    names_in(kUnits), text));
  }
  options.tolerance = length->number;
  options.tolerance_unit = length->unit;
}

comparing::PlaceTransform read_transform(storage::FileSystem& files, const std::string& path) {
  if (const std::uint64_t size = files.open(path)->size(); size > kMostTransformBytes)
    throw Error(ErrorCode::usage,
                fmt::format("{}: expected 16 numbers, found {} bytes", path, size));
  const auto bytes = storage::read_file(files, path, kMostTransformBytes);
  return comparing::parse_transform({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                    path);
}

/// Makes a hierarchy of the compared vertices, with their distances as an attribute.
class DifferenceHierarchy {
 public:
  DifferenceHierarchy(const comparing::ComparedPlace& from, const std::string& output,
                      comparing::CompareOptions& options, Environment& environment)
      : config_(exporting::config_like(from.files, from.path, output, options.replace,
                                       options.memory_budget, environment.files)),
        replaces_(options.replace),
        folder_(environment.files, output) {
    options.output = folder_.path() / "difference.ply";
    config_.input = options.output;
    config_.attributes = {};
  }

  /// Builds it and returns a text for people. It is shown as what it is: by the distances.
  std::string build(const comparing::SurfaceComparison& comparison, execution::Progress& progress,
                    Environment& environment) {
    config_.view = comparing::view_of(comparison);
    pipeline::BuildOptions options{.force = replaces_, .restart = pipeline::Restart::always};
    options.leaves_work = false;  // nobody could go on with it
    return pipeline::build_hierarchy(config_, options,
                                     {environment.files, progress, environment.cancel})
        .text;
  }

 private:
  config::Config config_;
  bool replaces_;
  exporting::MeshFolder folder_;
};

int run_compare(CompareArguments arguments, execution::ProgressMode mode,
                Environment& environment) {
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  comparing::CompareOptions& options = arguments.options;
  options.output = arguments.output;
  options.is_signed = !arguments.has_no_sign;
  options.scratch = temporary_path("meshhier-objects-");
  if (!arguments.transform.empty())
    options.transform = read_transform(environment.files, arguments.transform);
  options.inputs.emplace_back(arguments.transform);
  require_no_terminal(environment, arguments.output);
  std::ranges::copy_if(std::vector{arguments.from, arguments.to},
                       std::back_inserter(arguments.web.addresses), storage::is_web_address);
  const auto open = [&](const std::string& name) {
    return std::make_unique<ComparedHierarchy>(environment, name, arguments.web,
                                               options.memory_budget, *progress);
  };
  const auto from = open(arguments.from), to = open(arguments.to);
  for (const auto& compared : {std::cref(*from), std::cref(*to)}) {
    const std::vector<std::filesystem::path>& read = compared.get().read();
    options.inputs.insert(options.inputs.end(), read.begin(), read.end());
  }
  if (!arguments.output.empty())
    storage::require_apart(environment.files, arguments.output, options.inputs);
  std::optional<DifferenceHierarchy> difference;
  if (exporting::is_hierarchy_name(arguments.output))
    difference.emplace(from->place(), arguments.output, options, environment);
  const comparing::SurfaceComparison comparison = comparing::compare_surfaces(
      from->place(), to->place(), environment.files, options, *progress, environment.cancel);
  const std::string made = difference ? difference->build(comparison, *progress, environment) : "";
  progress->finish(comparison.is_within() ? "" : "farther than the tolerance");
  account_stream(environment, arguments.output)
      << (arguments.json ? pretty_json(comparison_json(comparison)) : comparison_text(comparison));
  environment.messages << made << from->account() << to->account();
  return comparison.is_within() ? 0 : kExitFarther;
}

constexpr const char* kCompareFooter =
    R"(For each vertex of FROM the exact distance to the surface of TO, negative inside of it: what moved
between two scans, how well a model fits its scan. Nothing is thinned out, and neither must fit into
memory. Percentiles and means are by area. Nothing aligns the two but --transform, which is made in
a program for that. Exit code 1 if a vertex is farther than the tolerance. Of a mesh a hierarchy is
built in TMPDIR, for as long as it takes. Of two addresses --header is for the host of the first,
unless a line begins with another one's: "https://b.org X-Key: 123", "localhost:8080 X-Key: 123".

The PLY has the property "distance", by which CloudCompare, MeshLab or ParaView colour it. A NAME.hier
or NAME.3tz is a hierarchy with the attribute "distance", for the page and preview --attribute.

Examples:
  meshhier compare monday.hier sunday.hier
  meshhier compare model.ply scan.ply --tolerance 0.5
  meshhier compare model.hier scan.hier --tolerance 0.5mm --json
  meshhier compare monday.hier sunday.hier -o moved.ply
  meshhier compare monday.hier sunday.hier -o moved.hier
  meshhier compare monday.3tz https://example.org/sunday.3tz --level 3
  meshhier compare https://a.org/m.3tz https://b.org/s.3tz --header "https://b.org X-Key: 123"
  meshhier compare a.hier b.hier --transform a_to_b.txt --unsigned
)";

/// Adds FROM and TO.
void add_compared(CLI::App& command, CompareArguments& arguments) {
  command
      .add_option("FROM", arguments.from,
                  "A hierarchy: a directory, an archive, an address; or a mesh")
      ->required();
  command.add_option("TO", arguments.to, "The one that distances are measured to")->required();
  add_web_options(command, arguments.web);
  CLI::App* what = add_group(command, "What", "At most one of these; else the original surfaces");
  add_detail_options(*what, "Of both this level; the root is 0", arguments.options.selection);
}

/// Adds what says how distances are measured.
void add_measuring(CLI::App& command, CompareArguments& arguments) {
  comparing::CompareOptions& options = arguments.options;
  command
      .add_option_function<std::string>(
          "--tolerance", [&options](const std::string& text) { store_tolerance(text, options); },
          "No vertex may be farther: a length in the units of TO, or with a unit: 0.5mm")
      ->type_name("LENGTH");
  command.add_flag("--unsigned", arguments.has_no_sign,
                   "Do not look on which side of TO the vertices are");
  command.add_flag("--bound", options.bounds_triangles,
                   "Bound tightly what lies between the vertices; takes up to three times as long");
  add_name_option(command,
                  {"--transform", "Moves FROM first: 16 numbers, a 4 x 4 matrix, rows first"},
                  arguments.transform);
}

/// Adds what says where the distances go.
void add_results(CLI::App& command, CompareArguments& arguments) {
  comparing::CompareOptions& options = arguments.options;
  add_name_option(command, {"-o,--output", "FROM with the distances: .hier or .3tz, or else a PLY"},
                  arguments.output);
  command.add_flag("--force", options.replace, "Replace a file that is there");
  add_integer_option(
      command,
      {"--objects", "List so many objects of FROM, the farthest first; 0: none [20]", 0,
       kMostObjects},
      [&options](std::uint64_t count) { options.listed_objects = static_cast<std::size_t>(count); })
      ->type_name("N");
  command.add_flag("--json", arguments.json, "For scripts");
}

}  // namespace

void add_compare_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command =
      parser.add_subcommand("compare", "Measure how far one mesh or hierarchy is from another");
  add_compared(*command, *arguments);
  add_measuring(*command, *arguments);
  add_results(*command, *arguments);
  add_memory_budget_option(*command, arguments->options.memory_budget);
  add_progress_option(*command, invocation.progress);
  command->footer(kCompareFooter);
  run_if_chosen(*command, invocation, arguments, run_compare);
}

}  // namespace meshhier::app
