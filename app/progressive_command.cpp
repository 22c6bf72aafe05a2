#include "app/command.h"
#include "app/options.h"
#include "progressive/stream.h"

#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

struct ProgressiveArguments {
  std::string directory;
  std::string output;
  progressive::ProgressiveOptions options;
};

int run_progressive(ProgressiveArguments& arguments, execution::ProgressMode mode,
                    Environment& environment) {
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  arguments.options.output = arguments.output;
  const std::string line = progressive::write_progressive(
      environment.files, arguments.directory, arguments.options, *progress, environment.cancel);
  progress->finish(arguments.output);
  environment.out << line << '\n';
  return 0;
}

constexpr const char* kProgressiveFooter =
    R"(The hierarchy must have been built with "simplify": {"method": "half_edge"}, and have one vertex at
each place ("topology": "index" makes it so). The base shows its coarsest level; with each detail a client shows the next finer one, with the last the original mesh
bit for bit, and needs no more than an array of vertices and one of triangles for it
("meshhier reconstruct"; docs/file_format.md).

Examples:
  meshhier progressive david.hier -o david.prog
  meshhier progressive david.hier --steps 3 -o david.prog
  meshhier progressive david.hier --node 3/5 -o sector.prog
)";

}  // namespace

void add_progressive_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<ProgressiveArguments>();
  CLI::App* command = parser.add_subcommand(
      "progressive", "Make a progressive stream for weak clients: a base and details");
  command->add_option("HIERARCHY", arguments->directory, "A directory or a 3tz archive")
      ->required();
  add_node_option(*command, "One sector on its own: its level and index", arguments->options.node);
  add_integer_option(*command,
                     {"--steps", "How many details; one a level if not given", 1, kDeepestLevel},
                     [arguments](std::uint64_t steps) {
                       arguments->options.steps = static_cast<std::uint32_t>(steps);
                     });
  add_name_option(*command, {"-o,--output", "The directory to make", "DIR"}, arguments->output)
      ->required();
  command->add_flag("--force", arguments->options.replace, "Replace a stream that is there");
  add_memory_budget_option(*command, arguments->options.memory_budget);
  add_progress_option(*command, invocation.progress);
  command->footer(kProgressiveFooter);
  run_if_chosen(*command, invocation, arguments, run_progressive);
}

}  // namespace meshhier::app
