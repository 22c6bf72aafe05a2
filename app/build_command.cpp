#include "app/command.h"
#include "app/options.h"
#include "config/config.h"
#include "config/config_reference.h"
#include "hierarchy/error.h"
#include "pipeline/build.h"
#include "pipeline/estimate.h"
#include "pipeline/plan/build_stats.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

struct BuildArguments {
  std::string config;
  std::vector<std::string> settings;
  std::string stats;  ///< file for the account; empty: none
  bool force = false;
  bool restart = false;
  bool dry_run = false;
  bool json = false;        ///< the estimate as JSON
  std::string help_config;  ///< one of kReferences, or empty
};

/// --set takes all that follows it, so it swallows a config that comes last: the one item without
/// "=" is given back. Without one, what is set must do.
void give_back_config(BuildArguments& arguments) {
  if (!arguments.config.empty())
    return;
  std::vector<std::string>& settings = arguments.settings;
  const auto found = std::find_if(settings.begin(), settings.end(), [](const std::string& item) {
    return item.find('=') == std::string::npos;
  });
  if (found == settings.end() && settings.empty())
    throw CLI::RequiredError("CONFIG, a config file,");
  if (found == settings.end())
    return;
  arguments.config = *found;
  settings.erase(found);
}

/// The account must not take the place of what the build reads or makes.
storage::OutputRequest stats_request(const BuildArguments& arguments,
                                     const config::Config& config) {
  storage::OutputRequest request{arguments.stats, arguments.force, config.input};
  request.inputs.push_back(config.output);
  return request;
}

void write_stats(storage::OutputFile& file, const pipeline::BuildStats& stats) {
  const std::string text = pretty_json(to_json(stats));
  file.publish(std::as_bytes(std::span(text)));
}

int run_estimate(const config::Config& config, const BuildArguments& arguments,
                 Environment& environment) {
  const pipeline::BuildEstimate estimate =
      pipeline::estimate_build(config, arguments.force, environment.files, environment.cancel);
  if (arguments.json) {
    environment.out << pretty_json(to_json(estimate));
  } else {
    environment.out << pipeline::estimate_text(estimate);
  }
  return 0;
}

int run_build(const BuildArguments& arguments, execution::ProgressMode mode,
              Environment& environment) {
  const config::Config config =
      arguments.config.empty()
          ? config::parse_config("{}", {"--set", {}}, arguments.settings)
          : config::load_config(environment.files, arguments.config, arguments.settings);
  if (arguments.dry_run)
    return run_estimate(config, arguments, environment);
  std::optional<storage::OutputFile> stats;
  if (!arguments.stats.empty()) {
    stats.emplace(environment.files, stats_request(arguments, config),
                  [&] { environment.cancel.check(); });
  }
  const auto progress =
      execution::make_progress(mode, environment.messages, environment.messages_on_terminal);
  const pipeline::BuildReport report =
      pipeline::build_hierarchy(config, {arguments.force, arguments.restart},
                                {environment.files, *progress, environment.cancel});
  progress->finish(config.output.string());
  if (stats)
    write_stats(*stats, report.stats);
  std::ostream& account = stats ? account_stream(environment, arguments.stats) : environment.out;
  account << report.text;
  if (!report.text.empty() && report.text.back() != '\n')
    account << '\n';
  return 0;
}

/// What --help-config prints.
const std::map<std::string, std::string (*)()>& references() {
  static const std::map<std::string, std::string (*)()> all = {{"text", config::keys_text},
                                                               {"schema", config::schema_text},
                                                               {"markdown", config::keys_markdown}};
  return all;
}

std::string footer() {
  return R"(The config is JSON; // comments are allowed. Only "input" and "output" are required.
"input" is a PLY, OBJ, STL or OFF, perhaps in gzip, or a list of files, which are joined; relative
to the config. With all defaults, `meshhier build --help-config` says what else there is:

)" + config::defaults_text() +
         R"(
Examples:
  meshhier build david.json
  meshhier build david.json --dry-run
  meshhier build --set input=david.ply output=david.hier
  meshhier build david.json --set partition.count=128 --set memory_budget=256MiB
  meshhier build david.json --set input=other.ply output=other.hier --force
  meshhier build david.json --set 'input=["a.obj.gz", "b.obj.gz"]' weld=true
  meshhier build david.json --set storage.container=3tz output=david.3tz
  meshhier build david.json --set storage.compression=meshopt_zlib storage.positions.bits=16
  meshhier build david.json --stats david.stats.json
)";
}

}  // namespace

void add_build_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<BuildArguments>();
  CLI::App* command = parser.add_subcommand("build", "Make a hierarchy from a mesh");
  command->add_option("CONFIG", arguments->config,
                      "The config file; without it --set gives input and output");
  command
      ->add_option("--set", arguments->settings,
                   "Override keys of the config, dotted: partition.vertices=4096. Paths given here "
                   "are relative to the "
                   "current directory")
      ->type_name("KEY=VALUE");
  command->add_flag("--force", arguments->force, "Replace an existing output");
  command->add_flag("--restart", arguments->restart,
                    "Throw away what an earlier build of this output, which was stopped, had done");
  CLI::Option* dry_run =
      command->add_flag("--dry-run", arguments->dry_run,
                        "Read only the mesh's header (or import it to count it); "
                        "tell what the build would make and take, or why it "
                        "would refuse");
  command->add_flag("--json", arguments->json, "With --dry-run: one JSON object, for programs")
      ->needs(dry_run);
  command
      ->add_option("--stats", arguments->stats,
                   "Write what each stage took of time, memory and disk, as JSON")
      ->type_name("FILE")
      ->excludes(dry_run);
  command
      ->add_flag("--help-config{text}", arguments->help_config,
                 "List the keys of the config; =schema: as a JSON schema, for editors; =markdown: "
                 "as a table")
      ->check(CLI::IsMember(references()));
  add_progress_option(*command, invocation.progress);
  command->footer(footer());
  command->callback([arguments, &invocation] {
    if (!arguments->help_config.empty()) {
      invocation.run = [arguments](Environment& environment) {
        environment.out << references().at(arguments->help_config)();
        return 0;
      };
      return;
    }
    give_back_config(*arguments);
    invocation.run = [arguments, &invocation](Environment& environment) {
      return run_build(*arguments, invocation.progress, environment);
    };
  });
}

}  // namespace meshhier::app
