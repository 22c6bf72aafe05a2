#include "app/command.h"
#include "app/options.h"
#include "inspection/inspect.h"

#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

struct InspectArguments {
  std::string directory;
  inspection::InspectOptions options;
  bool json = false;
};

int run_inspect(const InspectArguments& arguments, Environment& environment) {
  if (arguments.json) {
    environment.out << inspection::inspect_json(environment.files, arguments.directory,
                                                arguments.options)
                           .dump(2)
                    << '\n';
  } else {
    environment.out << inspection::inspect_text(environment.files, arguments.directory,
                                                arguments.options);
  }
  return 0;
}

constexpr const char* kInspectFooter = R"(Examples:
  meshhier inspect david.hier
  meshhier inspect david.hier --level 3
  meshhier inspect david.hier --json | jq .partitions
)";

}  // namespace

void add_inspect_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<InspectArguments>();
  CLI::App* command = parser.add_subcommand("inspect", "Tell what a hierarchy holds");
  command->add_option("HIERARCHY", arguments->directory, "A directory or a 3tz archive")
      ->required();
  command->add_flag("--json", arguments->json, "One JSON object, for programs");
  add_place_options(*command, arguments->options.level, arguments->options.node);
  command->footer(kInspectFooter);
  command->callback([arguments, &invocation] {
    invocation.run = [arguments](Environment& environment) {
      return run_inspect(*arguments, environment);
    };
  });
}

}  // namespace meshhier::app
