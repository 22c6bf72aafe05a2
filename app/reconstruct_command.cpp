#include "app/command.h"
#include "app/options.h"
#include "execution/size_text.h"
#include "progressive/reconstruct.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {

namespace {

struct ReconstructArguments {
  std::string directory;
  std::string output;
  progressive::ReconstructOptions options;
  bool stats = false;
};

/// Prints a line a file. The time to compute follows the number of its entries.
void print_stats(std::ostream& out, const progressive::ReconstructReport& report) {
  out << fmt::format("{:<14} {:>12} {:>12} {:>12} {:>12} {:>10} {:>9}\n", "file", "bytes",
                     "entries", "vertices", "triangles", "ms", "ns/entry");
  for (const progressive::ReconstructedStep& step : report.steps) {
    const auto entries = static_cast<double>(std::max<std::uint64_t>(step.entries, 1));
    out << fmt::format("{:<14} {:>12} {:>12} {:>12} {:>12} {:>10.2f} {:>9.1f}\n",
                       std::filesystem::path(step.file).filename().string(), step.bytes,
                       step.entries, step.vertices, step.triangles, step.seconds * 1e3,
                       step.seconds * 1e9 / entries);
  }
  out << fmt::format("the two arrays: {}\n", execution::rounded_size_text(report.array_bytes));
}

int run_reconstruct(ReconstructArguments& arguments, execution::ProgressMode mode,
                    Environment& environment) {
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  arguments.options.output = arguments.output;
  require_no_terminal(environment, arguments.output);
  std::ostream& account = account_stream(environment, arguments.output);
  const progressive::ReconstructReport report = progressive::reconstruct(
      environment.files, arguments.directory, arguments.options, *progress, environment.cancel);
  progress->finish(arguments.output);
  if (arguments.stats)
    print_stats(account, report);
  account << report.summary << '\n';
  return 0;
}

constexpr const char* kReconstructFooter = R"(Examples:
  meshhier reconstruct david.prog -o david.ply              the original, bit for bit
  meshhier reconstruct david.prog --details 2 -o coarse.ply  what a client shows after two details
  meshhier reconstruct david.prog --stats -o david.ply      and what each file took
)";

}  // namespace

void add_reconstruct_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<ReconstructArguments>();
  CLI::App* command =
      parser.add_subcommand("reconstruct", "Rebuild a mesh from a progressive stream");
  command->add_option("STREAM", arguments->directory, "What \"meshhier progressive\" made")
      ->required();
  add_integer_option(*command,
                     {"--details", "How many, in their order; all if not given", 0, kDeepestLevel},
                     [arguments](std::uint64_t details) {
                       arguments->options.details = static_cast<std::uint32_t>(details);
                     });
  command->add_flag("--stats", arguments->stats, "What each file holds and took");
  add_file_output_options(*command, "The PLY to write", arguments->output,
                          arguments->options.replace);
  add_memory_budget_option(*command, arguments->options.memory_budget);
  add_progress_option(*command, invocation.progress);
  command->footer(kReconstructFooter);
  run_if_chosen(*command, invocation, arguments, run_reconstruct);
}

}  // namespace meshhier::app
