#include "app/command.h"
#include "app/options.h"
#include "hierarchy/error.h"
#include "pipeline/verify.h"

#include <limits>
#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {

namespace {

struct VerifyArguments {
  std::string directory;
  std::string input;
  pipeline::VerifyOptions options;
  bool json = false;
};

/// A file name on disk may hold any bytes; JSON may not.
std::string json_text(const pipeline::VerifyReport& report) {
  const nlohmann::ordered_json object{
      {"ok", report.problems.empty()}, {"checks", report.checks}, {"problems", report.problems}};
  return object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::string verdict(const pipeline::VerifyReport& report) {
  const std::size_t count = report.problems.size();
  if (count == 0)
    return "No problem found";
  return fmt::format("{} problem{} found", count, count == 1 ? "" : "s");
}

std::string plain_text(const pipeline::VerifyReport& report) {
  std::string text;
  for (const std::string& check : report.checks)
    text += fmt::format("checked: {}\n", check);
  for (const std::string& problem : report.problems)
    text += fmt::format("PROBLEM: {}\n", problem);
  return text + verdict(report) + ".\n";
}

int run_verify(VerifyArguments arguments, pipeline::ProgressMode mode, Environment& environment) {
  if (!arguments.input.empty())
    arguments.options.input = arguments.input;
  const auto progress =
      pipeline::make_progress(mode, environment.messages, environment.messages_on_terminal);
  const pipeline::VerifyReport report = pipeline::verify_hierarchy(
      environment.files, arguments.directory, arguments.options, *progress, environment.cancel);
  progress->finish(verdict(report));
  environment.out << (arguments.json ? json_text(report) : plain_text(report));
  return report.problems.empty() ? 0 : static_cast<int>(ErrorCode::corrupt);
}

constexpr const char* kFooter =
    R"(Checks every file's checksum, the structure, and the seams of random cuts; with --input also that
the partitions are that mesh, vertex by vertex and triangle by triangle. Exit code 7 if there is a
problem.

Examples:
  meshhier verify david.hier
  meshhier verify david.hier --input david.ply --cuts 200 --seed 7
)";

}  // namespace

void add_verify_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<VerifyArguments>();
  pipeline::VerifyOptions& options = arguments->options;
  CLI::App* command = parser.add_subcommand("verify", "Prove that a hierarchy is sound");
  command->add_option("DIR", arguments->directory, "The hierarchy")->required();
  command->add_option("--input", arguments->input, "The mesh it was made from")->type_name("MESH");
  add_integer_option(
      *command,
      {"--cuts", "Random cuts whose seams are checked [20]", 0,
       std::numeric_limits<std::uint32_t>::max()},
      [&options](std::uint64_t cuts) { options.cuts = static_cast<std::uint32_t>(cuts); });
  add_integer_option(
      *command,
      {"--seed", "Which random cuts are taken [1]", 0, std::numeric_limits<std::uint64_t>::max()},
      [&options](std::uint64_t seed) { options.seed = seed; });
  add_memory_budget_option(*command, options.memory_budget);
  command->add_flag("--json", arguments->json, "One JSON object, for programs");
  add_progress_option(*command, invocation.progress);
  command->footer(kFooter);
  command->callback([arguments, &invocation] {
    invocation.run = [arguments, &invocation](Environment& environment) {
      return run_verify(*arguments, invocation.progress, environment);
    };
  });
}

}  // namespace meshhier::app
