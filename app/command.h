// The commands of the command line: each adds itself to the parser and, if chosen, leaves what is
// to be run.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "storage/io/file.h"

#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

#include <CLI/CLI.hpp>

namespace meshhier::app {

/// The surroundings that a command runs in.
struct Environment {
  storage::FileSystem& files;
  const execution::CancelToken& cancel;
  std::ostream& out;             ///< results
  std::ostream& messages;        ///< progress and errors
  execution::Terminal terminal;  ///< messages go there
  std::string program;           ///< its name as it was called, for lines to be typed
};

/// The command that the arguments ask for.
struct Invocation {
  std::function<int(Environment&)> run;  ///< returns the exit code; throws Error
  execution::ProgressMode progress = execution::ProgressMode::automatic;
  std::string program = "meshhier";
};

/// Lets `run` be what is run if arguments choose `command`: with its `arguments`, and the way to
/// tell progress if it takes that. `invocation` must outlive the parsing.
template <class Arguments, class Run>
void run_if_chosen(CLI::App& command, Invocation& invocation,
                   const std::shared_ptr<Arguments>& arguments, Run run) {
  command.callback([=, &invocation] {
    invocation.run = [=, &invocation](Environment& environment) {
      if constexpr (std::is_invocable_v<Run, Arguments&, Environment&>)
        return run(*arguments, environment);
      else
        return run(*arguments, invocation.progress, environment);
    };
  });
}

/// Each registers one subcommand of `parser`. When arguments choose it, `invocation` is filled;
/// both must outlive the parsing.
void add_build_command(CLI::App& parser, Invocation& invocation);
void add_inspect_command(CLI::App& parser, Invocation& invocation);
void add_verify_command(CLI::App& parser, Invocation& invocation);
void add_compare_command(CLI::App& parser, Invocation& invocation);
void add_query_command(CLI::App& parser, Invocation& invocation);
void add_export_command(CLI::App& parser, Invocation& invocation);
void add_preview_command(CLI::App& parser, Invocation& invocation);
void add_draw_command(CLI::App& parser, Invocation& invocation);
void add_view_command(CLI::App& parser, Invocation& invocation);
void add_page_command(CLI::App& parser, Invocation& invocation);
void add_progressive_command(CLI::App& parser, Invocation& invocation);
void add_reconstruct_command(CLI::App& parser, Invocation& invocation);
void add_serve_command(CLI::App& parser, Invocation& invocation);
void add_plan_command(CLI::App& parser, Invocation& invocation);
void add_task_command(CLI::App& parser, Invocation& invocation);
void add_clean_command(CLI::App& parser, Invocation& invocation);
/// These two tell of all commands that `parser` has when they run.
void add_completion_command(CLI::App& parser, Invocation& invocation);
void add_manual_command(CLI::App& parser, Invocation& invocation);

}  // namespace meshhier::app
