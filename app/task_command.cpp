#include "app/command.h"
#include "app/options.h"
#include "app/program_id.h"
#include "app/worker.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "pipeline/tasks/run_task.h"
#include "pipeline/tasks/task_plan.h"
#include "pipeline/tasks/task_status.h"
#include "storage/io/process.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {

namespace {

struct TaskArguments {
  std::string work;
  std::string stage;
  AskedWorker worker;
  std::string scratch;
  std::uint32_t threads = 0;
  std::uint64_t memory_budget = 0;
  bool status = false;
  bool stages = false;
  bool next = false;
  bool json = false;
};

int show_status(const TaskArguments& arguments, const pipeline::TaskPlan& plan,
                Environment& environment) {
  const pipeline::TaskStatus status =
      pipeline::task_status(plan, arguments.work, environment.files);
  const auto left = pipeline::cpu_seconds_left(status, plan, environment.files);
  environment.out << (arguments.json ? pretty_json(pipeline::status_json(status, plan, left))
                                     : pipeline::status_text(status, plan, left));
  return 0;
}

int list_stages(const pipeline::TaskPlan& plan, Environment& environment) {
  for (const pipeline::TaskStage& stage : pipeline::stages_of(plan))
    environment.out << fmt::format("{} {}\n", stage.name, stage.tasks);
  return 0;
}

/// Prints the first stage that is not complete, for scripts; nothing if all are.
int show_next(const TaskArguments& arguments, const pipeline::TaskPlan& plan,
              Environment& environment) {
  const pipeline::TaskStatus status =
      pipeline::task_status(plan, arguments.work, environment.files);
  if (const pipeline::StageStatus* next = pipeline::next_stage(status))
    environment.out << fmt::format("{} {}\n", next->name, next->tasks);
  return 0;
}

int run_task(const TaskArguments& arguments, execution::ProgressMode mode,
             Environment& environment) {
  const std::string program = program_id(environment.files);
  const pipeline::TaskPlan plan =
      pipeline::read_task_plan(environment.files, arguments.work, program);
  if (arguments.status)
    return show_status(arguments, plan, environment);
  if (arguments.stages)
    return list_stages(plan, environment);
  if (arguments.next)
    return show_next(arguments, plan, environment);
  if (arguments.stage.empty()) {
    throw Error(ErrorCode::usage,
                "which stage? --stages lists them, --status tells how far "
                "they are");
  }
  const pipeline::TaskStage stage = pipeline::find_stage(plan, arguments.stage);
  storage::allow_many_open_files();
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  const pipeline::TaskReport report =
      pipeline::run_tasks({arguments.work, stage.name,
                           find_worker(arguments.worker, stage.tasks, process_environment()),
                           arguments.scratch, arguments.threads, arguments.memory_budget, program},
                          {environment.files, *progress, environment.cancel});
  progress->finish(stage.name);
  environment.out << report.text;
  if (report.text.empty()) {
    environment.out << fmt::format("{}: {} done", stage.name, counted(report.done, "tasks"));
    if (report.found > 0)
      environment.out << fmt::format(", {} before", report.found);
    environment.out << '\n';
  }
  return 0;
}

constexpr const char* kTaskFooter =
    R"(Without --index and --of they come from the scheduler: SLURM_ARRAY_TASK_ID, SLURM_PROCID and
SLURM_NTASKS of srun, JOB_COMPLETION_INDEX, AWS_BATCH_JOB_ARRAY_INDEX; without any of these all tasks
of the stage are done, one after another. Tasks that are done already end at once, and a task may
run twice, even at once: a scheduler may try again whatever fails.

Exit codes that are worth another try: 4 (a file, a full disk, or a task before that is not done),
8 (another process is at work on finish) and 130 (interrupted). Others stay what they are.

Examples:
  meshhier task david.work read
  meshhier task david.work distribute                    all tasks of the stage
  meshhier task david.work leaves --index 3              task 3 alone
  meshhier task david.work leaves --index 1 --of 4       tasks 1, 5, 9, ...
  srun -n 8 meshhier task david.work level-1
  meshhier task david.work --status
)";

void add_worker_options(CLI::App& command, TaskArguments& arguments) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  add_integer_option(
      command,
      {"--index", "The first task of the stage to do; without --of the only one", 0, kMost},
      [&arguments](std::uint64_t index) {
        arguments.worker.index = static_cast<std::uint32_t>(index);
      });
  add_integer_option(
      command,
      {"--of", "Workers that share the stage: of N, this one does every Nth task", 1, kMost},
      [&arguments](std::uint64_t of) { arguments.worker.of = static_cast<std::uint32_t>(of); });
}

}  // namespace

void add_task_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<TaskArguments>();
  CLI::App* command = parser.add_subcommand("task", "Do tasks of a planned build, or list them");
  command->add_option("DIR", arguments->work, "What `meshhier plan` was given as --work")
      ->required()
      ->check(name_fault);
  command->add_option("STAGE", arguments->stage, "Of which stage");
  add_worker_options(*command, *arguments);
  add_name_option(
      *command,
      {"--scratch",
       "A directory of this machine for temporary files: only what is finished goes to DIR",
       "FOLDER"},
      arguments->scratch);
  constexpr std::uint64_t kMostThreads = 4096;
  add_integer_option(*command, {"--threads", "Instead of the config's", 1, kMostThreads},
                     [arguments](std::uint64_t threads) {
                       arguments->threads = static_cast<std::uint32_t>(threads);
                     });
  add_size_option(*command, "--memory-budget", "Instead of the config's", arguments->memory_budget);
  CLI::Option* status = command->add_flag(
      "--status", arguments->status, "Tell which tasks are done, what they took and what is left");
  CLI::Option* stages =
      command
          ->add_flag("--stages", arguments->stages, "List the stages, with their numbers of tasks")
          ->excludes(status);
  command
      ->add_flag("--next", arguments->next,
                 "The first stage that is not complete, with its number of tasks; nothing if all "
                 "is done")
      ->excludes(status)
      ->excludes(stages);
  command->add_flag("--json", arguments->json, "With --status: one JSON object, for programs")
      ->needs(status);
  add_progress_option(*command, invocation.progress);
  command->footer(kTaskFooter);
  run_if_chosen(*command, invocation, arguments, run_task);
}

}  // namespace meshhier::app
