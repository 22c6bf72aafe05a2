#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "base/error.h"
#include "inspection/inspect.h"
#include "inspection/list_objects.h"

#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

struct InspectArguments {
  std::string hierarchy;
  WebOptions web;
  inspection::InspectOptions options;
  std::optional<std::string> objects;  ///< what the names of those that are listed begin with
  std::string where;
  std::optional<std::string> words;  ///< that the names of those that are listed have
  bool json = false;
};

int run_inspect(const InspectArguments& arguments, Environment& environment) {
  const bool lists = arguments.objects || arguments.words;
  if (!arguments.where.empty() && !lists)
    throw Error(ErrorCode::usage, "--where: needs --objects or --find");
  const HierarchyPlace place(environment, arguments.hierarchy, arguments.web);
  if (lists) {
    inspection::list_objects(
        place.files(), place.path(),
        {arguments.objects.value_or(""), arguments.where, arguments.json, arguments.words},
        environment.cancel, [&](std::string_view line) { environment.out << line << '\n'; });
  } else if (arguments.json) {
    environment.out << pretty_json(
        inspection::inspect_json(place.files(), place.path(), arguments.options));
  } else {
    environment.out << inspection::inspect_text(place.files(), place.path(), arguments.options);
  }
  environment.messages << place.account();
  return 0;
}

constexpr const char* kInspectFooter = R"(Examples:
  meshhier inspect david.hier
  meshhier inspect david.hier --level 3
  meshhier inspect david.hier --json | jq .partitions
  meshhier inspect town.hier --objects
  meshhier inspect town.hier --objects=Main_Street/ --json | jq .properties.height
  meshhier inspect town.hier --objects --where 'storeys > 3 and owner is null'
  meshhier inspect town.hier --find 'church mar'
)";

}  // namespace

void add_inspect_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<InspectArguments>();
  CLI::App* command = parser.add_subcommand("inspect", "Print what a hierarchy holds");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);
  command->add_flag("--json", arguments->json,
                    "One JSON object, for programs; of objects one a line");
  command
      ->add_option("--objects", arguments->objects,
                   "List the objects instead: their names, sizes and properties. --objects=PREFIX "
                   "those whose names begin so")
      ->expected(0, 1);
  command
      ->add_option("--find", arguments->words,
                   "List the objects whose names have these words, in any order; the last one "
                   "may be the beginning of a word")
      ->excludes("--objects");
  add_where_option(*command, arguments->where);
  add_place_options(*command, arguments->options.level, arguments->options.node);
  command->footer(kInspectFooter);
  run_if_chosen(*command, invocation, arguments, run_inspect);
}

}  // namespace meshhier::app
