#include "app/command.h"
#include "app/options.h"
#include "pipeline/journal/clean.h"

#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

struct CleanArguments {
  std::string path = ".";
  bool remove = false;
  bool json = false;
};

int run_clean(const CleanArguments& arguments, Environment& environment) {
  auto found = pipeline::find_leftovers(environment.files, arguments.path);
  if (arguments.remove)
    pipeline::remove_leftovers(environment.files, found);
  if (arguments.json) {
    environment.out << pretty_json(pipeline::leftovers_json(found));
  } else {
    environment.out << pipeline::leftovers_text(found, arguments.remove);
  }
  return 0;
}

constexpr const char* kCleanFooter =
    R"(A build that was stopped keeps what it has done beside its output, so that the same build can go on.
This lists such work, what other commands left that were killed, and notes of serve --watch about
hierarchies that are gone. What commands that are at work need is left alone.

Examples:
  meshhier clean                        what lies in this directory
  meshhier clean models/david.hier      what belongs to this hierarchy
  meshhier clean models --remove
)";

}  // namespace

void add_clean_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<CleanArguments>();
  CLI::App* command = parser.add_subcommand("clean", "List or remove what stopped builds left");
  command->add_option("PATH", arguments->path,
                      "A directory, or a hierarchy, finished or not; default: this directory");
  command->add_flag("--remove", arguments->remove, "Remove it");
  command->add_flag("--json", arguments->json, "One JSON object, for programs");
  command->footer(kCleanFooter);
  run_if_chosen(*command, invocation, arguments, run_clean);
}

}  // namespace meshhier::app
