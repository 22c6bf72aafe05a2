#include "app/build_arguments.h"
#include "app/build_batch.h"
#include "app/command.h"
#include "app/options.h"
#include "app/shell_word.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "config/config.h"
#include "config/config_reference.h"
#include "config/named_files.h"
#include "execution/size_text.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_folder.h"
#include "pipeline/build.h"
#include "pipeline/estimate.h"
#include "pipeline/plan/build_plan.h"
#include "pipeline/plan/build_stats.h"
#include "pipeline/update.h"
#include "storage/io/json_text.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {

namespace {

constexpr std::size_t kLongestPath = 4096;

/// Returns the request for a file, which must not take the place of one that the build reads or
/// makes.
storage::OutputRequest output_request(const std::string& path, const BuildArguments& arguments,
                                      const config::Config& config) {
  storage::OutputRequest request{path, arguments.force, config::read_by(config)};
  request.inputs.push_back(config.output);
  request.inputs.insert(request.inputs.end(), arguments.named.begin(), arguments.named.end());
  return request;
}

/// Whether the file is the account of an earlier build.
bool is_account(const std::string& path, storage::FileSystem& files) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  if (files.kind(path) != storage::FileKind::regular || files.identity(path).bytes > kMostBytes)
    return false;
  const std::vector<std::byte> bytes = storage::read_file(files, path, kMostBytes);
  const auto account = storage::parse_ordered_json_text(
      {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, nullptr, {.throws = false});
  return account.is_object() && account.contains("generator") && account.contains("stages");
}

/// Returns the request for the account. --update replaces that of the build before.
storage::OutputRequest stats_request(const BuildArguments& arguments, const config::Config& config,
                                     storage::FileSystem& files) {
  storage::OutputRequest request = output_request(arguments.stats, arguments, config);
  request.replace = request.replace || (arguments.update && is_account(arguments.stats, files));
  return request;
}

/// Throws if both files are one: the first would go when the second gets its name.
void require_two_files(const BuildArguments& arguments, storage::FileSystem& files) {
  if (arguments.stats.empty() || arguments.input_note.empty())
    return;
  const bool are_standard_output = storage::is_standard_output(files, arguments.stats) &&
                                   storage::is_standard_output(files, arguments.input_note);
  const bool is_one_file =
      files.canonical(arguments.stats) == files.canonical(arguments.input_note) &&
      files.kind(arguments.stats) != storage::FileKind::stream;
  if (are_standard_output || is_one_file) {
    throw Error(
        ErrorCode::usage,
        fmt::format("--stats and --input-note both name {}; name two files", arguments.input_note));
  }
}

/// Returns the request for the note. Only an older note, or a file that --force may replace, is
/// replaced; that is checked before the build, and after it.
storage::OutputRequest note_request(const BuildArguments& arguments, const config::Config& config,
                                    storage::FileSystem& files) {
  storage::OutputRequest request = output_request(arguments.input_note, arguments, config);
  if (files.kind(request.path) != storage::FileKind::regular)
    return request;
  storage::require_apart(files, request.path, request.inputs);
  if (request.replace)
    return request;
  try {
    storage::read_input_note(*files.open(request.path), arguments.input_note);
    request.replace = true;  // it says which hierarchy it belongs to
  } catch (const Error&) {
    throw Error(ErrorCode::exists, arguments.input_note + " is already there, and is no note of " +
                                       "a build; --force replaces it");
  }
  return request;
}

/// Writes the note, when all is done: a build that is killed leaves none for an unfinished
/// hierarchy.
void write_input_note(const BuildArguments& arguments, const config::Config& config,
                      const storage::InputNote& note, const Environment& environment) {
  const std::string text = to_json_text(note);
  storage::OutputFile(environment.files, note_request(arguments, config, environment.files))
      .publish(std::as_bytes(std::span(text)));
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

/// Returns the line that shows the hierarchy in the browser.
std::string serve_line(const config::Config& config, const std::string& program) {
  const std::filesystem::path parent = config.output.parent_path();
  std::string folder = parent.empty() ? "." : parent.string();
  if (folder.starts_with('-'))
    folder.insert(0, "./");
  return shell_word(program) + " serve " + shell_word(folder) + " --open";
}

std::vector<std::filesystem::path> others_of(const BuildArguments& arguments) {
  std::vector<std::filesystem::path> others;
  for (const std::string& path : {arguments.stats, arguments.input_note}) {
    if (!path.empty() && path != storage::kStandardOutput)
      others.emplace_back(path);
  }
  return others;
}

/// Returns the file system that refuses files which may not be read; null if all may.
std::unique_ptr<storage::FileSystem> guarded_files(const BuildArguments& arguments) {
  if (!arguments.within.empty())
    return storage::make_posix_file_system({false, arguments.within});
  return arguments.no_links ? storage::make_posix_file_system({false, std::nullopt}) : nullptr;
}

/// Tells programs the warnings of the account; people read them there.
void tell_warnings(std::string_view account, execution::Progress& progress) {
  constexpr std::string_view kMark = "warning: ";
  while (!account.empty()) {
    const std::string_view line = account.substr(0, account.find('\n'));
    if (line.starts_with(kMark))
      progress.warn(line.substr(kMark.size()));
    account.remove_prefix(std::min(line.size() + 1, account.size()));
  }
}

/// Tells programs by an event, people by a line.
void tell_update(const char* event, const std::string& message, execution::ProgressMode mode,
                 std::ostream& out, const Environment& environment) {
  if (mode == execution::ProgressMode::json) {
    const nlohmann::ordered_json told{{"event", event}, {"message", message}};
    environment.messages << storage::json_text(told) << std::endl;
  } else {
    out << message << std::endl;
  }
}

/// Whether the output is up to date, with --update; tells that, or why it is not.
bool is_up_to_date(const BuildArguments& arguments, const config::Config& config,
                   execution::ProgressMode mode, execution::Progress& progress,
                   const Environment& environment) {
  if (!arguments.update)
    return false;
  const std::string reason = pipeline::reason_to_build(
      config, arguments.input_note, {environment.files, progress, environment.cancel});
  const std::string output = plain_text(config.output.string(), kLongestPath);
  if (reason.empty()) {
    tell_update("up_to_date", output + " is up to date", mode, environment.out, environment);
  } else if (mode == execution::ProgressMode::json || environment.terminal.is_terminal) {
    tell_update("outdated", fmt::format("{} is built: {}", output, reason), mode,
                environment.messages, environment);
  }
  return reason.empty();
}

/// Builds. What a stopped build of another config or input has left is kept, but from `--update`,
/// which is to end with an output that is up to date.
pipeline::BuildReport run_build(const BuildArguments& arguments, const config::Config& config,
                                const pipeline::BuildEnvironment& environment) {
  pipeline::BuildOptions options{arguments.force || arguments.update, arguments.restart,
                                 others_of(arguments)};
  try {
    return pipeline::build_hierarchy(config, options, environment);
  } catch (const Error& error) {
    if (!arguments.update || error.code() != ErrorCode::other_work)
      throw;
  }
  options.restart = true;
  return pipeline::build_hierarchy(config, options, environment);
}

/// Checks the files that are to be written besides, and builds.
int run_one(const BuildArguments& arguments, const config::Config& config,
            execution::ProgressMode mode, const Environment& environment) {
  require_two_files(arguments, environment.files);
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  if (is_up_to_date(arguments, config, mode, *progress, environment))
    return 0;
  std::optional<storage::OutputFile> stats;
  if (!arguments.stats.empty()) {
    stats.emplace(environment.files, stats_request(arguments, config, environment.files),
                  [&] { environment.cancel.check(); });
  }
  if (!arguments.input_note.empty())
    note_request(arguments, config, environment.files);
  if (environment.terminal.is_terminal && mode != execution::ProgressMode::json &&
      mode != execution::ProgressMode::none) {
    environment.messages << fmt::format(
        "at most {} of memory, {}\n", execution::rounded_size_text(pipeline::memory_budget(config)),
        counted(pipeline::thread_count(config), "threads"));
  }
  const pipeline::BuildReport report =
      run_build(arguments, config, {environment.files, *progress, environment.cancel});
  if (mode == execution::ProgressMode::json)
    tell_warnings(report.text, *progress);
  progress->finish(config.output.string());
  if (stats)
    write_stats(*stats, report.stats);
  if (!arguments.input_note.empty())
    write_input_note(arguments, config, report.input, environment);
  std::ostream& out = stats ? account_stream(environment, arguments.stats) : environment.out;
  out << report.text;
  if (arguments.verbose)
    out << report.account;
  out << "next: " << serve_line(config, environment.program) << '\n';
  return 0;
}

int run_build(BuildArguments arguments, execution::ProgressMode mode, const Environment& around) {
  const auto guarded = guarded_files(arguments);
  Environment environment{guarded ? *guarded : around.files,
                          around.cancel,
                          around.out,
                          around.messages,
                          around.terminal,
                          around.program};
  if (arguments.each)
    return run_batch(arguments, mode, environment);
  config::CommandLine words(arguments.settings);
  words.output = arguments.output;
  storage::FileSystem& files = arguments.no_links ? environment.files.input() : environment.files;
  const config::Config config =
      config::load_named(files, {arguments.named.begin(), arguments.named.end()}, std::move(words));
  if (arguments.dry_run)
    return run_estimate(config, arguments, environment);
  if (arguments.update && arguments.input_note.empty())
    arguments.input_note = pipeline::input_note_path(config, environment.files).string();
  return run_one(arguments, config, mode, environment);
}

using References = std::map<std::string, std::string (*)()>;

/// Returns the forms that --help-config prints.
const References& key_references() {
  static const References all = {{"text", config::keys_text},
                                 {"schema", config::schema_text},
                                 {"markdown", config::keys_markdown}};
  return all;
}

/// Returns the forms that --help-formats prints.
const References& format_references() {
  static const References all = {{"text", config::formats_text},
                                 {"json", config::formats_json},
                                 {"markdown", config::formats_markdown}};
  return all;
}

/// Returns the text to print instead of a build; null if there is to be a build.
std::string (*reference_of(const BuildArguments& arguments))() {
  if (!arguments.help_config.empty())
    return key_references().at(arguments.help_config);
  return arguments.help_formats.empty() ? nullptr : format_references().at(arguments.help_formats);
}

std::string footer() {
  return "FILE is a mesh: a " + mesh_io::format_names() +
         R"(, perhaps in gzip, a tileset.json or .3tz, or a folder with
)" + mesh_io::folder_names() +
         R"(. The hierarchy of scan.ply is made beside it, as scan.hier,
unless -o names another. Several meshes are joined. --set changes the keys of a config;
`meshhier build --help-config` says what they mean.

FILE may be a config instead, for jobs to be repeated: JSON with // comments. It needs "input" (a
mesh, or a list of meshes) and "output", both relative to the config. With all defaults:

)" + config::defaults_text() +
         R"(
Examples:
  meshhier build david.ply
  meshhier build david.ply -o models/david.hier --force
  meshhier build david.ply --dry-run
  meshhier build david.obj.gz -o david.3tz --set memory_budget=256MiB
  meshhier build left.obj.gz right.obj.gz -o both.hier --set weld=true
  meshhier build david.ply --set storage.compression=meshopt_zlib storage.positions.bits=16
  meshhier build project/ -o project.hier
  meshhier build david.json
  meshhier build david.json --set partition.count=128 -o coarse.hier --stats coarse.json
  meshhier build --each scans/*.ply -o models/ --jobs 2 --update
)";
}

/// Adds --each and --jobs; returns the first.
CLI::Option* add_batch_options(CLI::App& command, BuildArguments& arguments) {
  CLI::Option* each = command.add_flag(
      "--each", arguments.each,
      "Make a hierarchy of each FILE, a mesh or a config; -o names the folder for all");
  constexpr std::uint64_t kMostJobs = 256;
  add_integer_option(command, {"--jobs", "With --each: so many builds at once [1]", 1, kMostJobs},
                     [&arguments](std::uint64_t jobs) { arguments.jobs = jobs; })
      ->needs(each);
  return each;
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

}  // namespace

void add_build_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<BuildArguments>();
  CLI::App* command = parser.add_subcommand("build", "Make a hierarchy from a mesh");
  command->add_option("FILE", arguments->named,
                      "A mesh, several meshes that are joined, or a config");
  command
      ->add_option("-o,--output", arguments->output,
                   "The hierarchy to make: a directory, or one file if it ends in .3tz")
      ->type_name("PATH")
      ->check(name_fault);
  command
      ->add_option("--set", arguments->settings,
                   "Set keys of the config, dotted: partition.vertices=4096. Paths given here "
                   "are relative to the "
                   "current directory")
      ->type_name("KEY=VALUE");
  command
      ->add_option_function<std::string>(
          "--drape",
          [arguments](const std::string& picture) {
            arguments->settings.push_back("texture.drape=" + picture);
          },
          "The orthophoto (GeoTIFF) that heights of a raster show")
      ->type_name("FILE");
  command
      ->add_option_function<std::string>(
          "--objects",
          [arguments](const std::string& source) {
            arguments->settings.push_back("objects.from=" + source);
          },
          "What objects are made from: node, group, object, material, file, solid, feature, "
          "label:NAME, or none")
      ->type_name("SOURCE");
  command
      ->add_option_function<std::string>(
          "--object-table",
          [arguments](const std::string& table) {
            arguments->settings.push_back("objects.table=" + table);
          },
          "Properties of the objects: CSV or lines of JSON, with a column id or name")
      ->type_name("FILE");
  CLI::Option* force = command->add_flag("--force", arguments->force, "Replace an existing output");
  command->add_flag("--restart", arguments->restart,
                    "Throw away what an earlier build of this output, which was stopped, had done");
  command->add_flag("--verbose", arguments->verbose,
                    "Also print what each stage took of time, memory and disk");
  CLI::Option* no_links =
      command->add_flag("--no-links", arguments->no_links,
                        "Refuse input files and configs with a link in their paths");
  command
      ->add_option("--within", arguments->within,
                   "Read no input file that lies outside this folder, or behind a link in it")
      ->type_name("FOLDER")
      ->check(name_fault)
      ->excludes(no_links);
  CLI::Option* dry_run =
      command->add_flag("--dry-run", arguments->dry_run,
                        "Read only the mesh's header (or import it to count it); "
                        "tell what the build would make and take, or why it "
                        "would refuse");
  command
      ->add_flag("--update", arguments->update,
                 "Build only if the output is not of this input, config and program; it is "
                 "replaced then, as with --force")
      ->excludes(force)
      ->excludes(dry_run);
  add_batch_options(*command, *arguments)->excludes(dry_run);
  command->add_flag("--json", arguments->json, "With --dry-run: one JSON object, for programs")
      ->needs(dry_run);
  command
      ->add_option("--stats", arguments->stats,
                   "Write what each stage took of time, memory and disk, as JSON")
      ->type_name("FILE")
      ->check(name_fault)
      ->excludes(dry_run);
  command
      ->add_option("--input-note", arguments->input_note,
                   "Write which files were read, with sizes, times and checksums, and which were "
                   "missing, as JSON")
      ->type_name("FILE")
      ->check(name_fault)
      ->excludes(dry_run);
  command
      ->add_flag("--help-config{text}", arguments->help_config,
                 "List the keys of the config; =schema: as a JSON schema, for editors; =markdown: "
                 "as a table")
      ->check(CLI::IsMember(key_references()));
  command
      ->add_flag("--help-formats{text}", arguments->help_formats,
                 "List the formats of meshes and what is kept of each; =json: these and those of "
                 "pictures, for programs; =markdown: as a table")
      ->check(CLI::IsMember(format_references()));
  add_progress_option(*command, invocation.progress);
  command->footer(footer());
  command->callback([arguments, command, &invocation] {
    if (const auto reference = reference_of(*arguments); reference != nullptr) {
      invocation.run = [reference](Environment& environment) {
        environment.out << reference();
        return 0;
      };
      return;
    }
    give_back_files(arguments->settings, arguments->named);
    check_batch(*command, *arguments);
    invocation.run = [arguments, &invocation](Environment& environment) {
      return run_build(*arguments, invocation.progress, environment);
    };
  });
}

}  // namespace meshhier::app
