#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "base/error.h"
#include "base/number_text.h"
#include "base/plain_text.h"
#include "storage/io/process.h"
#include "verify/verify.h"
#include "verify/verify_error.h"

#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {

namespace {

struct VerifyArguments {
  std::string hierarchy;
  WebOptions web;
  std::vector<std::string> input;
  verifying::VerifyOptions options;
  bool measures_error = false;
  verifying::ErrorOptions error;
  bool json = false;
};

std::string json_text(const verifying::VerifyReport& report) {
  const nlohmann::ordered_json object{
      {"ok", report.problems.empty()}, {"checks", report.checks}, {"problems", report.problems}};
  return pretty_json(object);
}

std::string verdict(std::size_t count) {
  if (count == 0)
    return "No problem found";
  return counted(count, "problems") + " found";
}

/// Problems are cut there, as a manifest may say anything.
constexpr std::size_t kLongestProblem = 4096;

std::string plain_text(const verifying::VerifyReport& report) {
  std::string text;
  for (const std::string& check : report.checks)
    text += fmt::format("checked: {}\n", check);
  for (const std::string& problem : report.problems)
    text += fmt::format("PROBLEM: {}\n", meshhier::plain_text(problem, kLongestProblem));
  return text + verdict(report.problems.size()) + ".\n";
}

using Measurements = std::vector<verifying::ErrorMeasurement>;

/// Returns one object, or with all levels an object with a list of them.
std::string json_text(const Measurements& measurements, bool all_levels) {
  if (!all_levels)
    return pretty_json(verifying::to_json(measurements.front()));
  auto levels = nlohmann::ordered_json::array();
  for (const verifying::ErrorMeasurement& measurement : measurements)
    levels.push_back(verifying::to_json(measurement));
  return pretty_json({{"levels", levels}});
}

std::string plain_text(const Measurements& measurements, std::size_t problems) {
  std::string text;
  for (const verifying::ErrorMeasurement& measurement : measurements)
    text += to_text(measurement) + '\n';
  return text + verdict(problems) + ".\n";
}

int exit_code(std::size_t problems) {
  return problems == 0 ? 0 : static_cast<int>(ErrorCode::corrupt);
}

int run_error(VerifyArguments arguments, const HierarchyPlace& place, execution::Progress& progress,
              Environment& environment) {
  arguments.error.memory_budget = arguments.options.memory_budget;
  const Measurements measurements = verifying::measure_errors(
      place.files(), place.path(), arguments.error, progress, environment.cancel);
  std::size_t problems = 0;
  for (const verifying::ErrorMeasurement& measurement : measurements)
    problems += measurement.problems.size();
  progress.finish(verdict(problems));
  const bool all_levels = std::holds_alternative<verifying::AllLevels>(arguments.error.selection);
  environment.out << (arguments.json ? json_text(measurements, all_levels)
                                     : plain_text(measurements, problems));
  return exit_code(problems);
}

int run_verify(VerifyArguments arguments, execution::ProgressMode mode, Environment& environment) {
  arguments.options.input.assign(arguments.input.begin(), arguments.input.end());
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  const HierarchyPlace place(environment, arguments.hierarchy, arguments.web);
  if (arguments.measures_error)
    return run_error(arguments, place, *progress, environment);
  if (!arguments.options.region.crs.empty())
    require_region(arguments.options.region, "--crs");
  if (place.is_remote())
    arguments.options.scratch_folder = storage::temporary_folder();
  const verifying::VerifyReport report = verifying::verify_hierarchy(
      place.files(), place.path(), arguments.options, *progress, environment.cancel);
  progress->finish(verdict(report.problems.size()));
  environment.out << (arguments.json ? json_text(report) : plain_text(report));
  environment.messages << place.account();
  return exit_code(report.problems.size());
}

constexpr const char* kVerifyFooter =
    R"(Checks every file's checksum, the structure, and the seams of random cuts; with --input also that
the partitions are that mesh, vertex by vertex and triangle by triangle. With --error none of that
is done; the distance between what is shown and the original partitions is measured instead, both
ways, and held against the tiles' bounds. With --box or --polygon only tiles that may reach there are
looked at, of all levels: of a hierarchy on the web little else is fetched. Exit code 7 if there is a
problem.

Examples:
  meshhier verify david.hier
  meshhier verify david.hier --input david.ply --cuts 200 --seed 7
  meshhier verify david.3tz
  meshhier verify https://example.org/town.3tz --box 0,0,-10 200,100,90
  meshhier verify both.hier --input left.obj.gz --input right.obj.gz
  meshhier verify david.hier --error --level 3
  meshhier verify david.hier --error --level all --samples 1000000 --json
)";

/// Stores --level L | all.
void store_level(const std::string& text, verifying::ErrorOptions& error) {
  if (text == "all") {
    error.selection = verifying::AllLevels{};
    return;
  }
  const auto level = parse_number<std::uint8_t>(text);
  if (!level || *level > kDeepestLevel) {
    throw CLI::ValidationError(
        "--level", fmt::format("expected an integer from 0 to {} or \"all\", found \"{}\"",
                               kDeepestLevel, text));
  }
  error.selection = static_cast<Level>(*level);
}

/// A thousand times the samples of usual comparisons: they take hours, but are no defect.
constexpr std::uint64_t kMostSamples = 400'000'000;

void add_error_options(CLI::App& command, VerifyArguments& arguments,
                       const std::vector<CLI::Option*>& others) {
  verifying::ErrorOptions& error = arguments.error;
  CLI::Option* mode =
      command.add_flag("--error", arguments.measures_error,
                       "Measure the distance to the original partitions, and do nothing else");
  for (CLI::Option* other : others)
    mode->excludes(other);
  CLI::Option* samples = add_integer_option(
      command, {"--samples", "With --error: samples in each direction [400000]", 1, kMostSamples},
      [&error](std::uint64_t count) { error.samples = count; });
  CLI::Option* level = command.add_option_function<std::string>(
      "--level", [&error](const std::string& text) { store_level(text, error); },
      "With --error: the level that is measured, or all simplified levels [0]");
  CLI::Option* cut = command.add_option_function<std::string>(
      "--cut", [&error](const std::string& file) { error.selection = std::filesystem::path(file); },
      "With --error: measure the cut that this file lists, as export takes one");
  cut->type_name("FILE")->check(
      [](const std::string& text) { return text.empty() ? "expected a file, found nothing" : ""; });
  level->type_name("L|all")->excludes(cut);
  for (CLI::Option* option : {samples, level, cut})
    option->needs(mode);
}

}  // namespace

void add_verify_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<VerifyArguments>();
  verifying::VerifyOptions& options = arguments->options;
  CLI::App* command =
      parser.add_subcommand("verify", "Prove that a hierarchy is sound, or measure its errors");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);
  CLI::Option* input_option = command->add_option(
      "--input", arguments->input, "The mesh it was made from; several in the order of the config");
  input_option->type_name("MESH")->take_all();
  CLI::Option* cuts_option = add_integer_option(
      *command,
      {"--cuts", "Random cuts whose seams are checked [20]", 0,
       std::numeric_limits<std::uint32_t>::max()},
      [&options](std::uint64_t cuts) { options.cuts = static_cast<std::uint32_t>(cuts); });
  CLI::Option* seed_option = add_integer_option(
      *command,
      {"--seed", "Which random cuts are taken [1]", 0, std::numeric_limits<std::uint64_t>::max()},
      [&options](std::uint64_t seed) { options.seed = seed; });
  CLI::App* region = add_region_options(*command, options.region);
  std::vector<CLI::Option*> others{input_option, cuts_option, seed_option};
  for (CLI::Option* option : region->get_options()) {
    option->excludes(input_option);
    others.push_back(option);
  }
  add_error_options(*command, *arguments, others);
  add_memory_budget_option(*command, options.memory_budget);
  command->add_flag("--json", arguments->json, "One JSON object, for programs");
  add_progress_option(*command, invocation.progress);
  command->footer(kVerifyFooter);
  run_if_chosen(*command, invocation, arguments, run_verify);
}

}  // namespace meshhier::app
