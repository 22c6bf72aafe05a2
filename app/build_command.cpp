#include "app/build_arguments.h"
#include "app/build_batch.h"
#include "app/build_help.h"
#include "app/build_one.h"
#include "app/command.h"
#include "app/options.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

/// Returns the file system that refuses files which may not be read; null if all may.
std::unique_ptr<storage::FileSystem> guarded_files(const BuildArguments& arguments) {
  if (!arguments.within.empty())
    return storage::make_posix_file_system({false, arguments.within});
  return arguments.no_links ? storage::make_posix_file_system({false, std::nullopt}) : nullptr;
}

int run_build(const BuildArguments& arguments, execution::ProgressMode mode,
              const Environment& around) {
  const auto guarded = guarded_files(arguments);
  const Environment environment{guarded ? *guarded : around.files,
                                around.cancel,
                                around.out,
                                around.messages,
                                around.terminal,
                                around.program};
  if (arguments.each)
    return run_batch(arguments, mode, environment);
  const config::Config config = load_config(arguments, environment.files);
  return arguments.dry_run ? tell_estimate(arguments, config, environment)
                           : build_one(arguments, config, mode, environment);
}

/// Returns the text to print instead of a build; null if there is to be a build.
std::string (*reference_of(const BuildArguments& arguments))() {
  if (!arguments.help_config.empty())
    return key_references().at(arguments.help_config);
  return arguments.help_formats.empty() ? nullptr : format_references().at(arguments.help_formats);
}

/// Adds --each and --jobs.
void add_batch_options(CLI::App& command, BuildArguments& arguments) {
  CLI::Option* each = command.add_flag(
      "--each", arguments.each,
      "Make a hierarchy of each FILE, a mesh or a config; -o names the folder for all");
  constexpr std::uint64_t kMostJobs = 256;
  add_integer_option(command, {"--jobs", "With --each: so many builds at once [1]", 1, kMostJobs},
                     [&arguments](std::uint64_t jobs) { arguments.jobs = jobs; })
      ->needs(each);
}

/// Adds FILE and -o.
void add_places(CLI::App& command, BuildArguments& arguments) {
  command
      .add_option("FILE", arguments.named, "A mesh, several meshes that are joined, or a config")
      ->check(name_fault);
  add_made_hierarchy_option(command, arguments.output);
}

/// Adds --set, and options of their own for keys that are set often.
void add_key_options(CLI::App& command, BuildArguments& arguments) {
  command
      .add_option("--set", arguments.settings,
                  "Set keys of the config, dotted: partition.vertices=4096. Paths given here "
                  "are relative to the current directory")
      ->type_name("KEY=VALUE");
  struct KeyOption {
    const char *name, *key, *value, *help;
  };
  for (const KeyOption& option :
       {KeyOption{"--drape", "texture.drape=", "FILE",
                  "The orthophoto (GeoTIFF) that heights of a raster show"},
        KeyOption{"--objects", "objects.from=", "SOURCE",
                  "What objects are made from: node, group, object, material, file, solid, "
                  "feature, label:NAME, or none"},
        KeyOption{"--object-table", "objects.table=", "FILE",
                  "Properties of the objects: CSV or lines of JSON, with a column id or name"}}) {
    command
        .add_option_function<std::string>(
            option.name,
            [&arguments, key = option.key](const std::string& value) {
              arguments.settings.push_back(key + value);
            },
            option.help)
        ->type_name(option.value);
  }
}

/// Adds --force, --restart and --verbose.
void add_build_flags(CLI::App& command, BuildArguments& arguments) {
  command.add_flag("--force", arguments.force, "Replace an existing output");
  command.add_flag("--restart", arguments.restart,
                   "Throw away what an earlier build of this output, which was stopped, had done");
  command  // for `serve --watch`
      .add_flag("--restart-other", arguments.restart_other,
                "Does so only if that is of another config or input")
      ->group("");
  command.add_flag("--verbose", arguments.verbose,
                   "Also print what each stage took of time, memory and disk");
}

/// Adds --no-links and --within.
void add_input_rules(CLI::App& command, BuildArguments& arguments) {
  CLI::Option* no_links =
      command.add_flag("--no-links", arguments.no_links,
                       "Refuse input files and configs with a link in their paths");
  add_name_option(
      command,
      {"--within", "Read no input file that lies outside this folder, or behind a link in it",
       "FOLDER"},
      arguments.within)
      ->excludes(no_links);
}

/// Adds --dry-run and --update.
void add_judgements(CLI::App& command, BuildArguments& arguments) {
  command.add_flag("--dry-run", arguments.dry_run,
                   "Read only the mesh's header (or import it to count it); "
                   "tell what the build would make and take, or why it "
                   "would refuse");
  command
      .add_flag("--update", arguments.update,
                "Build only if the output is not of this input, config and program; it is "
                "replaced then, as with --force")
      ->excludes(command.get_option("--force"));
}

/// Adds --json, --stats and --input-note.
void add_accounts(CLI::App& command, BuildArguments& arguments) {
  CLI::Option* const dry_run = command.get_option("--dry-run");
  command.add_flag("--json", arguments.json, "With --dry-run: one JSON object, for programs")
      ->needs(dry_run);
  const auto add = [&](const char* name, std::string& file, const char* help) {
    add_name_option(command, {name, help}, file)->excludes(dry_run);
  };
  add("--stats", arguments.stats, "Write what each stage took of time, memory and disk, as JSON");
  add("--input-note", arguments.input_note,
      "Write which files were read, with sizes, times and checksums, and which were missing, as "
      "JSON");
}

/// Adds --help-config and --help-formats.
void add_references(CLI::App& command, BuildArguments& arguments) {
  command
      .add_flag("--help-config{text}", arguments.help_config,
                "List the keys of the config; =schema: as a JSON schema, for editors; =markdown: "
                "as a table")
      ->check(CLI::IsMember(key_references()));
  command
      .add_flag("--help-formats{text}", arguments.help_formats,
                "List the formats of meshes and what is kept of each; =json: these and those of "
                "pictures, for programs; =markdown: as a table")
      ->check(CLI::IsMember(format_references()));
}

/// Throws for options that are for one build alone.
void check_batch(const CLI::App& command, const BuildArguments& arguments) {
  if (!arguments.each)
    return;
  for (const char* option : {"--stats", "--input-note", "--verbose"}) {
    if (command.count(option) > 0)
      throw CLI::ExcludesError("--each", option);
  }
  if (arguments.named.empty())
    throw CLI::RequiredError("FILE");
}

/// Returns what the arguments ask for. Throws for those that do not go together.
std::function<int(Environment&)> chosen_run(const CLI::App& command,
                                            const std::shared_ptr<BuildArguments>& arguments,
                                            const Invocation& invocation) {
  if (const auto reference = reference_of(*arguments); reference != nullptr) {
    return [reference](Environment& environment) {
      environment.out << reference();
      return 0;
    };
  }
  give_back_files(arguments->settings, arguments->named);
  check_batch(command, *arguments);
  return [arguments, &invocation](Environment& environment) {
    return run_build(*arguments, invocation.progress, environment);
  };
}

}  // namespace

void add_build_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<BuildArguments>();
  CLI::App* command = parser.add_subcommand("build", "Make a hierarchy from a mesh");
  for (const auto add :
       {add_places, add_key_options, add_build_flags, add_input_rules, add_judgements,
        add_batch_options, add_accounts, add_references})  // in this order in the help
    add(*command, *arguments);
  add_progress_option(*command, invocation.progress);
  command->footer(build_footer());
  command->callback([arguments, command, &invocation] {
    invocation.run = chosen_run(*command, arguments, invocation);
  });
}

}  // namespace meshhier::app
