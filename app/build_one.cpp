#include "app/build_one.h"

#include "app/build_files.h"
#include "app/options.h"
#include "app/shell_word.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "config/named_files.h"
#include "execution/size_text.h"
#include "pipeline/build.h"
#include "pipeline/plan/build_plan.h"
#include "pipeline/update.h"
#include "storage/io/told_json.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

constexpr std::size_t kLongestPath = 4096;

/// Returns the line that shows the hierarchy in the browser.
std::string serve_line(const config::Config& config, const std::string& program) {
  const std::filesystem::path parent = config.output.parent_path();
  std::string folder = parent.empty() ? "." : parent.string();
  if (folder.starts_with('-'))
    folder.insert(0, "./");
  return shell_word(program) + " serve " + shell_word(folder) + " --open";
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
void tell_update(const char* event, const std::string& message, const config::Config& config,
                 execution::ProgressMode mode, std::ostream& out, const Environment& environment) {
  if (mode == execution::ProgressMode::json) {
    const nlohmann::ordered_json told{
        {"event", event}, {"message", message}, {"output", config.output.string()}};
    environment.messages << storage::told_json_text(told) << std::endl;
  } else {
    out << message << std::endl;
  }
}

std::string output_text(const config::Config& config) {
  return plain_text(config.output.string(), kLongestPath);
}

std::string up_to_date_text(const config::Config& config) {
  return output_text(config) + " is up to date";
}

/// Returns what is asked, with the place of the note that --update reads: beside the output, if
/// none is named. Throws Error(usage) for one that cannot be read.
BuildArguments with_note(BuildArguments asked, const config::Config& config,
                         storage::FileSystem& files) {
  const std::string& named = asked.input_note;
  if (!asked.update)
    return asked;
  if (named.empty())
    asked.input_note = pipeline::input_note_path(config, files).string();
  else if (storage::is_standard_output(files, named) ||
           files.kind(named) == storage::FileKind::stream)
    throw Error(ErrorCode::usage,
                "--input-note " + named + ": --update reads it again, so it must be a file");
  return asked;
}

/// Returns why the build is due, for --update; empty if it is not.
std::string reason_to_build(const BuildArguments& arguments, const config::Config& config,
                            execution::Progress& progress, const Environment& environment) {
  return pipeline::reason_to_build(config, arguments.input_note,
                                   {environment.files, progress, environment.cancel});
}

/// Whether the output is up to date, with --update; tells that, or why it is not.
bool is_up_to_date(const BuildArguments& arguments, const config::Config& config,
                   execution::ProgressMode mode, execution::Progress& progress,
                   const Environment& environment) {
  if (!arguments.update)
    return false;
  const std::string reason = reason_to_build(arguments, config, progress, environment);
  if (reason.empty()) {
    tell_update("up_to_date", up_to_date_text(config), config, mode, environment.out, environment);
  } else if (mode == execution::ProgressMode::json || environment.terminal.is_terminal) {
    tell_update("outdated", fmt::format("{} is built: {}", output_text(config), reason), config,
                mode, environment.messages, environment);
  }
  return reason.empty();
}

pipeline::Restart restart_of(const BuildArguments& arguments) {
  if (arguments.restart)
    return pipeline::Restart::always;
  return arguments.update || arguments.restart_other ? pipeline::Restart::other_work
                                                     : pipeline::Restart::never;
}

void tell_limits(const config::Config& config, execution::ProgressMode mode,
                 const Environment& environment) {
  if (!environment.terminal.is_terminal || mode == execution::ProgressMode::json ||
      mode == execution::ProgressMode::none)
    return;
  environment.messages << fmt::format("at most {} of memory, {}\n",
                                      execution::rounded_size_text(pipeline::memory_budget(config)),
                                      counted(pipeline::thread_count(config), "threads"));
}

}  // namespace

config::Config load_config(const BuildArguments& arguments, storage::FileSystem& files) {
  config::CommandLine words(arguments.settings);
  words.output = arguments.output;
  return config::load_named(arguments.no_links ? files.input() : files,
                            {arguments.named.begin(), arguments.named.end()}, std::move(words));
}

int build_one(const BuildArguments& asked, const config::Config& config,
              execution::ProgressMode mode, const Environment& environment) {
  const BuildArguments arguments = with_note(asked, config, environment.files);
  BuildFiles besides(arguments, config, environment);
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  const auto before = pipeline::state_of_output(config, environment.files);
  if (is_up_to_date(arguments, config, mode, *progress, environment))
    return 0;
  besides.begin();
  tell_limits(config, mode, environment);
  pipeline::BuildOptions options{arguments.force || arguments.update, restart_of(arguments),
                                 besides.paths()};
  options.is_due = [&] {  // another one may have made it meanwhile
    return pipeline::state_of_output(config, environment.files) == before ||
           !is_up_to_date(arguments, config, mode, *progress, environment);
  };
  options.on_made = [&](const pipeline::BuildReport& made) { besides.write(made); };
  const auto report =
      pipeline::build_if_due(config, options, {environment.files, *progress, environment.cancel});
  if (!report)
    return 0;
  if (mode == execution::ProgressMode::json)
    tell_warnings(report->text, *progress);
  progress->finish(config.output.string());
  std::ostream& out = besides.text_stream();
  out << report->text;
  if (arguments.verbose)
    out << report->account;
  out << "next: " << serve_line(config, environment.program) << '\n';
  return 0;
}

std::optional<pipeline::BuildEstimate> estimate_one(const BuildArguments& arguments,
                                                    const config::Config& config,
                                                    execution::Progress& progress,
                                                    const Environment& environment) {
  const BuildArguments asked = with_note(arguments, config, environment.files);
  if (asked.update && reason_to_build(asked, config, progress, environment).empty())
    return std::nullopt;
  return pipeline::estimate_build(config, arguments.force || arguments.update, environment.files,
                                  environment.cancel);
}

int tell_estimate(const BuildArguments& arguments, const config::Config& config,
                  const Environment& environment) {
  execution::NoProgress silent;
  const auto estimate = estimate_one(arguments, config, silent, environment);
  if (arguments.json) {
    environment.out << pretty_json(
        estimate
            ? to_json(*estimate)
            : nlohmann::ordered_json{{"output", config.output.string()}, {"up_to_date", true}});
  } else {
    environment.out << (estimate ? pipeline::estimate_text(*estimate)
                                 : up_to_date_text(config) + '\n');
  }
  return 0;
}

}  // namespace meshhier::app
