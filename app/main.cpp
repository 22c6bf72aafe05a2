// meshhier: the command line.
#include "app/command.h"
#include "app/parser_walk.h"
#include "app/process.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "config/suggest.h"
#include "execution/memory_budget.h"
#include "execution/size_text.h"
#include "execution/threads.h"
#include "storage/io/output_file.h"
#include "storage/io/told_json.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {

namespace {

using namespace std::string_view_literals;

constexpr const char* kDescription =
    R"(meshhier makes a hierarchy from one huge triangle mesh: a directory, or one file, of tiles of
about equal size, from a coarse view of the whole model down to the original triangles, for viewers that load
what the user looks at.)";

constexpr const char* kFooter = R"(Examples:
  meshhier build david.ply                           make the hierarchy david.hier beside the mesh
  meshhier inspect david.hier                        what is in it
  meshhier verify david.hier --input david.ply       prove that it holds the input exactly
  meshhier compare new.hier old.hier --tolerance 0.5 how far two scans are from each other
  meshhier query david.hier --points p.csv           the nearest place of each point
  meshhier export david.hier --level 0 -o whole.ply  the coarse view of the whole model
  meshhier progressive david.hier -o david.prog      a base and details, for weak clients
  meshhier page david.hier -o david.html             one file to send, which opens by a double click
  meshhier serve models --open                       show all hierarchies of a folder in the browser
  meshhier plan david.ply --work w --tasks 16        cut a build into tasks for many machines
  meshhier clean                                     what builds that were stopped left here

"meshhier COMMAND --help" tells more.

Exit codes:
  0    done
  1    compare: a vertex is farther than the tolerance; serve --check: it is not so
  2    the command line or the config is wrong
  3    the input mesh is broken or not supported
  4    a file could not be read or written
  5    the output is already there (see --force)
  6    the memory budget or the free disk space is too small
  7    the hierarchy is damaged: verify found a problem
  8    another process is at work on the output; try again later
  9    what a stopped build left belongs to another config or input (see build --restart)
  10   build --each, serve --once: several failed, for different reasons
  70   a defect in meshhier
  130  interrupted by Ctrl-C or SIGTERM; the same build goes on where it was (serve: 0)
)";

/// The least --memory-budget. The program with its libraries takes 20 to 30 MiB before it has read
/// anything.
constexpr std::uint64_t kLeastBudget = std::uint64_t{32} << 20;

constexpr const char* kNoMemory =
    "the system has no more memory; lower memory_budget or close other programs";

int exit_code(ErrorCode code) {
  return static_cast<int>(code);
}

std::vector<std::string> command_names(const CLI::App& parser) {
  std::vector<std::string> names;
  for (const CLI::App* command : parser.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// Returns the names of the commands that the help lists.
std::string listed_commands(const CLI::App& parser) {
  std::vector<std::string> names;
  for (const CLI::App* command :
       parser.get_subcommands([](const CLI::App* one) { return !one->get_group().empty(); }))
    names.push_back(command->get_name());
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Whether the word is a misspelt command: the parser's own message would only be that one is
/// missing.
bool is_unknown_command(const std::string& word, const std::vector<std::string>& names) {
  return !word.starts_with('-') && std::find(names.begin(), names.end(), word) == names.end();
}

/// Returns the message for an unknown command; a file in its place is taken for a mesh.
std::string unknown_command(const std::string& word, const CLI::App& parser) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(word, ignored))
    return fmt::format("a command is missing; did you mean \"meshhier build {}\"?", word);
  const std::optional<std::string> near = config::nearest_word(word, command_names(parser));
  return "unknown command \"" + word + '"' +
         (near ? "; did you mean \"" + *near + "\"?"
               : "; expected one of " + listed_commands(parser));
}

std::string no_command(const CLI::App& parser) {
  return "a command is missing; the first word is one of " + listed_commands(parser);
}

/// Tells a failure and returns the exit code. Programs that read the progress get it in the same
/// form.
int report_failure(ErrorCode code, const std::string& message, execution::ProgressMode mode) {
  if (mode == execution::ProgressMode::json) {
    const nlohmann::ordered_json event{
        {"event", "error"}, {"code", exit_code(code)}, {"message", message}};
    std::cerr << storage::told_json_text(event) << '\n';
  } else {
    std::cerr << "meshhier: " << message << '\n';
  }
  return exit_code(code);
}

/// Whether mistakes in the arguments are for a program, too: they are found before the options are
/// known.
bool asks_for_json(std::span<char* const> arguments) {
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string_view word = arguments[i];
    if (word == "--progress=json" || (word == "json" && arguments[i - 1] == "--progress"sv))
      return true;
  }
  return false;
}

int report_mistake(const std::string& message, bool as_json) {
  const std::string hint = as_json ? "" : "\nRun with --help for more.";
  return report_failure(ErrorCode::usage, message + hint,
                        as_json ? execution::ProgressMode::json : execution::ProgressMode::none);
}

/// Throws if a result did not arrive, as when the disk behind a redirection is full.
void flush_results() {
  if (!std::cout.flush())
    throw Error(ErrorCode::io, "standard output could not be written");
}

int execute(const Invocation& invocation, const execution::CancelToken& cancel) {
  const std::unique_ptr<storage::FileSystem> files = storage::make_posix_file_system();
  execution::limit_threads_to_startable();
  Environment environment{*files,    cancel,           std::cout,
                          std::cerr, error_terminal(), invocation.program};
  const int code = invocation.run(environment);
  flush_results();
  return code;
}

/// Throws if a file that any command is told to write takes the place of one that it is told to
/// read. The files that those name, a command checks itself.
void require_inputs_stay(const CLI::App& command, storage::FileSystem& files) {
  const CLI::Option* const each = command.get_option_no_throw("--each");
  if (each != nullptr && each->count() > 0)
    return;  // -o is a folder, in which meshes may lie, too; each build checks its own output
  const std::vector<std::filesystem::path> read = files_named(command, FileUse::read);
  for (const std::filesystem::path& output : files_named(command, FileUse::written)) {
    const bool is_stream = storage::is_standard_output(files, output) ||
                           files.kind(output) == storage::FileKind::stream;
    if (!is_stream)
      storage::require_apart(files, output, read);
  }
}

/// Refuses a --memory-budget that is less than the program takes by itself; warns of one that is
/// beyond what the process may use.
void check_budget(const CLI::App& command, execution::ProgressMode mode, Environment& environment) {
  const CLI::Option* const option = command.get_option_no_throw("--memory-budget");
  if (option == nullptr || option->count() == 0)
    return;
  const auto bytes = execution::parse_size(option->results().back());
  if (bytes && *bytes < kLeastBudget) {
    throw Error(
        ErrorCode::budget,
        fmt::format("--memory-budget {} is too small: the program itself takes nearly {}; "
                    "give that or more",
                    execution::exact_size_text(*bytes), execution::exact_size_text(kLeastBudget)));
  }
  const std::string warning =
      bytes ? execution::budget_warning("--memory-budget", *bytes) : std::string();
  if (!warning.empty())
    execution::make_progress(mode, environment.messages, environment.terminal)->warn(warning);
}

/// The one place where failures end.
int execute_guarded(const Invocation& invocation, const execution::CancelToken& cancel) {
  const auto fail = [&](ErrorCode code, const std::string& message) {
    return report_failure(code, message, invocation.progress);
  };
  try {
    return execute(invocation, cancel);
  } catch (const Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::budget, kNoMemory);
  } catch (const std::filesystem::filesystem_error& error) {
    const std::string path = error.path1().string();
    return fail(ErrorCode::io,
                path.empty() ? error.what() : "cannot use " + path + ": " + error.code().message());
  } catch (const std::exception& error) {
    if (const std::string what = execution::thread_failure(error); !what.empty())
      return fail(ErrorCode::budget, what);
    return fail(ErrorCode::internal,
                std::string("a defect in meshhier, please report it: ") + json_fault(error.what()));
  }
}

/// Ends the process for an exception that cannot be caught, as it left a thread or came while
/// another failure was on its way: with its message and exit code, but with files on disk as after
/// a kill.
[[noreturn]] void end_told() {
  const auto end = [](ErrorCode code, const char* message) {
    std::fprintf(stderr, "meshhier: %s\n", message);
    std::_Exit(exit_code(code));
  };
  try {
    if (std::current_exception())
      std::rethrow_exception(std::current_exception());
    // Where there is no memory for an exception itself, none is there to be caught.
    constexpr std::size_t kExceptionBytes = 256;
    void* volatile const memory = std::malloc(kExceptionBytes);
    if (memory == nullptr)
      end(ErrorCode::budget, kNoMemory);
    end(ErrorCode::internal,
        "a defect in meshhier, please report it: it was ended without a cause");
  } catch (const Error& error) {
    end(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    end(ErrorCode::budget, kNoMemory);
  } catch (const std::exception& error) {
    const std::string what = execution::thread_failure(error);
    end(what.empty() ? ErrorCode::internal : ErrorCode::budget,
        what.empty() ? error.what() : what.c_str());
  } catch (...) {
    end(ErrorCode::internal, "a defect in meshhier, please report it: an unknown failure");
  }
  std::_Exit(exit_code(ErrorCode::internal));
}

/// Returns the arguments as the parser takes them, the last one first. What stands behind "--" is a
/// file, which the parser would take for an option if one of several values stands before.
std::vector<std::string> words_of(std::span<char* const> arguments) {
  std::vector<std::string> words(arguments.begin() + 1, arguments.end());
  for (auto word = std::find(words.begin(), words.end(), "--"); word != words.end(); ++word) {
    if (word->starts_with('-') && *word != "-" && *word != "--")
      word->insert(0, "./");
  }
  std::ranges::reverse(words);
  return words;
}

/// Adds all commands, in the order in which the help lists them.
void add_commands(CLI::App& parser, Invocation& invocation) {
  for (const auto add :
       {add_build_command, add_inspect_command, add_verify_command, add_compare_command,
        add_query_command, add_export_command, add_preview_command, add_draw_command,
        add_view_command, add_page_command, add_progressive_command, add_reconstruct_command,
        add_serve_command, add_plan_command, add_task_command, add_clean_command,
        add_completion_command, add_manual_command})
    add(parser, invocation);
}

/// Returns what stands before the chosen command's own work: checks of what it is told.
std::function<int(Environment&)> with_checks(const CLI::App& parser, const Invocation& invocation) {
  return [&, chosen = invocation.run](Environment& environment) {
    for (const CLI::App* command : parser.get_subcommands()) {
      require_inputs_stay(*command, environment.files);
      check_budget(*command, invocation.progress, environment);
    }
    return chosen(environment);
  };
}

int run(std::span<char* const> arguments, const execution::CancelToken& cancel) {
  Invocation invocation;
  if (!arguments.empty())
    invocation.program = arguments[0];
  CLI::App parser(kDescription, "meshhier");
  parser.set_version_flag("--version", "meshhier " MESHHIER_VERSION);
  parser.require_subcommand(1);
  parser.footer(kFooter);
  add_commands(parser, invocation);

  const bool as_json = asks_for_json(arguments);
  if (arguments.size() <= 1)
    return report_mistake(no_command(parser), as_json);
  if (is_unknown_command(arguments[1], command_names(parser)))
    return report_mistake(unknown_command(arguments[1], parser), as_json);
  try {
    parser.parse(words_of(arguments));
    invocation.run = with_checks(parser, invocation);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      return report_mistake(parser.get_subcommands().empty() ? no_command(parser) : error.what(),
                            as_json);
    }
    invocation.run = [&](Environment&) { return parser.exit(error); };  // --help and --version
    return execute_guarded(invocation, cancel);
  }
  return execute_guarded(invocation, cancel);
}

}  // namespace

}  // namespace meshhier::app

int main(int argc, char** argv) {
  std::set_terminate(meshhier::app::end_told);
  meshhier::app::reserve_standard_descriptors();
  return meshhier::app::run({argv, static_cast<std::size_t>(argc)}, meshhier::app::signal_token());
}
