#include "app/command.h"
#include "app/options.h"
#include "app/program_id.h"
#include "app/shell_word.h"
#include "base/plain_text.h"
#include "config/config.h"
#include "config/named_files.h"
#include "pipeline/tasks/task_plan.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {

namespace {

struct PlanArguments {
  std::vector<std::string> named;  ///< a config, or meshes
  std::string output;
  std::vector<std::string> settings;
  std::string work;
  std::uint64_t tasks = 0;
  bool force = false;
};

/// Returns the line that runs a stage.
std::string stage_line(const pipeline::TaskStage& stage, const std::string& task) {
  if (stage.tasks == 1)
    return fmt::format("  {} {}\n", task, stage.name);
  return fmt::format("  {} {} --index I      for I from 0 to {}\n", task, stage.name,
                     stage.tasks - 1);
}

int run_plan(const PlanArguments& arguments, Environment& environment) {
  config::CommandLine words(arguments.settings);
  words.output = arguments.output;
  const config::Config config = config::load_named(
      environment.files, {arguments.named.begin(), arguments.named.end()}, std::move(words));
  const std::filesystem::path work = environment.files.canonical(arguments.work);
  execution::NoProgress silent;
  const pipeline::TaskPlan plan =
      pipeline::make_task_plan(config,
                               {work, static_cast<std::uint32_t>(arguments.tasks), arguments.force,
                                program_id(environment.files)},
                               {environment.files, silent, environment.cancel});
  const std::vector<pipeline::TaskStage> stages = pipeline::stages_of(plan);
  std::ostream& out = environment.out;
  out << fmt::format(
      "planned {} of {} for {}; run one stage after the other, the tasks of a stage "
      "in any order and at once:\n",
      counted(stages.size(), "stages"), work.string(), plan.config.output.string());
  const std::string task = shell_word(environment.program) + " task " + shell_word(work.string());
  for (const pipeline::TaskStage& stage : stages)
    out << stage_line(stage, task);
  out << fmt::format("how far it is: {} --status\n", task);
  return 0;
}

constexpr const char* kPlanFooter =
    R"(Cuts a build into tasks that Slurm, Kubernetes, GNU parallel or a person runs on as many machines
as there are. All must see DIR, the mesh and the output at the same paths; DIR must be on the file
system of the output. The hierarchy has the same bytes as that of `meshhier build`.

N is best twice the number of processes that run at once, or more. scripts/cluster has complete
examples; docs/cluster.md says what the shared folder must do and when all this does not pay.

Examples:
  meshhier plan david.ply --work david.work --tasks 16
  meshhier task david.work --stages                    the stages and how many tasks each has
  meshhier task david.work leaves --index 3
)";

}  // namespace

void add_plan_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<PlanArguments>();
  CLI::App* command = parser.add_subcommand("plan", "Cut a build into tasks for many machines");
  command->add_option("FILE", arguments->named,
                      "A mesh, several meshes that are joined, or a config, as for build");
  add_name_option(*command, {"--work", "The directory for what the tasks make; it is made", "DIR"},
                  arguments->work)
      ->required();
  add_integer_option(*command,
                     {"--tasks", "Tasks that a stage is cut into", 1, pipeline::kMostTasks},
                     [arguments](std::uint64_t tasks) { arguments->tasks = tasks; })
      ->required();
  add_made_hierarchy_option(*command, arguments->output);
  command->add_option("--set", arguments->settings, "Set keys of the config, as for build")
      ->type_name("KEY=VALUE");
  command->add_flag("--force", arguments->force, "Replace an existing output");
  command->footer(kPlanFooter);
  command->callback([arguments, &invocation] {
    give_back_files(arguments->settings, arguments->named);
    invocation.run = [arguments](Environment& environment) {
      return run_plan(*arguments, environment);
    };
  });
}

}  // namespace meshhier::app
