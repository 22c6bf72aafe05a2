#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "base/error.h"
#include "config/view_config.h"
#include "inspection/kept_view.h"

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::app {
namespace {

struct ViewArguments {
  std::string hierarchy;
  WebOptions web;
  std::string link;
  std::vector<std::string> settings;
  bool clears = false;

  bool is_change() const { return clears || !link.empty() || !settings.empty(); }
};

/// Returns the view that is asked for.
ModelView asked_view(const ViewArguments& arguments, const ModelView& kept,
                     std::ostream& messages) {
  ModelView view = arguments.clears ? ModelView{} : kept;
  if (!arguments.link.empty()) {
    const inspection::LinkedView linked = inspection::view_of_link(arguments.link, view);
    view = linked.view;
    if (!linked.others.empty())
      messages << fmt::format("left out, as it is no part of a view: {}\n",
                              fmt::join(linked.others, ", "));
  }
  return config::with_settings(view, arguments.settings);
}

int run_view(const ViewArguments& arguments, Environment& environment) {
  const HierarchyPlace place(environment, arguments.hierarchy, arguments.web);
  ModelView view = inspection::kept_view(place.files(), place.path());
  if (arguments.is_change()) {
    if (place.is_remote())
      throw Error(ErrorCode::usage,
                  "a hierarchy on the web cannot be changed from here; change "
                  "the directory that its server has");
    view = asked_view(arguments, view, environment.messages);
    inspection::keep_view(place.files(), place.path(), view);
  }
  environment.out << inspection::view_text(view) << '\n';
  return 0;
}

constexpr const char* kViewFooter =
    R"(Without an option it prints the view, as the config's key "view" has it; {} if there is none. Viewers,
preview and inspect show it; "meshhier build --help-config" lists its keys. Only the manifest is written anew, in
one step, so the directory may be served meanwhile and verify finds all in order. preview.webp stays
as the build drew it: the manifest holds its checksum, and two files cannot change in one step. An archive is never changed: build it with the view in its config.

Examples:
  meshhier view scan.hier
  meshhier view scan.hier --set view.attribute=quality --set view.ramp=turbo
  meshhier view scan.hier --link 'http://localhost:8080/#scan.hier&1,2,3,0,0,0&light=raking'
  meshhier view scan.hier --clear
)";

}  // namespace

void add_view_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command =
      parser.add_subcommand("view", "Print or change how a hierarchy is shown first");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web);
  add_name_option(
      *command, {"--link", "Takes what this link of the page says, from # on or all of it", "LINK"},
      arguments->link);
  command
      ->add_option("--set", arguments->settings,
                   "Changes a key: view.KEY=VALUE, or view={...} for all of it")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--clear", arguments->clears, "Forgets the view that is there");
  command->footer(kViewFooter);
  run_if_chosen(*command, invocation, arguments, run_view);
}

}  // namespace meshhier::app
