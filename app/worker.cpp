#include "app/worker.h"

#include "base/error.h"
#include "base/number_text.h"
#include "base/plain_text.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

std::optional<std::uint32_t> number(const Variables& variables, const char* name) {
  const std::optional<std::string> text = variables(name);
  if (!text || text->empty())
    return std::nullopt;
  const auto value = parse_number<std::uint32_t>(*text);
  if (!value) {
    throw Error(ErrorCode::usage, fmt::format("the variable {} is \"{}\", and no number: give "
                                              "--index and --of",
                                              name, meshhier::plain_text(*text, 60)));
  }
  return value;
}

/// Returns the worker of that number, among as many as the largest number needs.
pipeline::Share with_number(std::uint32_t index, std::uint32_t largest) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  return {index, largest < kMost ? largest + 1 : kMost};
}

/// Returns the worker in a Slurm array. An array from 0 or 1 on is one of workers. In another, or
/// one that has only some indices, as when a few are run again, the index is the number of the
/// task.
std::optional<pipeline::Share> slurm_array(const Variables& variables, std::uint32_t tasks) {
  const auto id = number(variables, "SLURM_ARRAY_TASK_ID");
  if (!id)
    return std::nullopt;
  const std::uint32_t least = number(variables, "SLURM_ARRAY_TASK_MIN").value_or(0);
  const std::uint32_t most = number(variables, "SLURM_ARRAY_TASK_MAX").value_or(*id);
  const std::uint32_t step = std::max(number(variables, "SLURM_ARRAY_TASK_STEP").value_or(1), 1U);
  const std::uint32_t count = number(variables, "SLURM_ARRAY_TASK_COUNT").value_or(0);
  const bool is_whole = least <= 1 && count > 1 && count - 1 == (most - least) / step;
  if (least <= *id && *id <= most && is_whole)
    return pipeline::Share{(*id - least) / step, count};
  return with_number(*id, std::max({most, *id, tasks - 1}));
}

/// Returns the worker in a step of srun. A batch script has these variables too, but is not one of
/// so many processes.
std::optional<pipeline::Share> slurm_step(const Variables& variables) {
  const auto index = number(variables, "SLURM_PROCID");
  const auto of = number(variables, "SLURM_NTASKS");
  const bool is_batch_script = variables("SLURM_JOB_ID") && !variables("SLURM_STEP_ID");
  if (!index || !of || is_batch_script)
    return std::nullopt;
  return pipeline::Share{*index, *of};
}

/// Returns the worker that two variables tell. `count`: null if the scheduler does not tell how
/// many there are.
std::optional<pipeline::Share> indexed(const Variables& variables, const char* index,
                                       const char* count, std::uint32_t tasks) {
  const auto value = number(variables, index);
  if (!value)
    return std::nullopt;
  const auto told = count != nullptr ? number(variables, count) : std::nullopt;
  return told ? pipeline::Share{*value, *told} : with_number(*value, std::max(tasks - 1, *value));
}

pipeline::Share of_environment(std::uint32_t tasks, const Variables& variables) {
  const auto array = slurm_array(variables, tasks);
  const auto step = slurm_step(variables);
  if (array && step) {
    const std::uint64_t of = std::uint64_t{array->of} * step->of;
    if (of > std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorCode::usage, "Slurm's variables tell of more workers than there can be");
    return {array->index * step->of + step->index, static_cast<std::uint32_t>(of)};
  }
  if (array || step)
    return array ? *array : *step;
  if (const auto job = indexed(variables, "JOB_COMPLETION_INDEX", nullptr, tasks))
    return *job;
  if (const auto job =
          indexed(variables, "AWS_BATCH_JOB_ARRAY_INDEX", "AWS_BATCH_JOB_ARRAY_SIZE", tasks))
    return *job;
  return {};
}

}  // namespace

Variables process_environment() {
  return [](const char* name) -> std::optional<std::string> {
    const char* const value = std::getenv(name);
    return value != nullptr ? std::optional<std::string>(value) : std::nullopt;
  };
}

pipeline::Share find_worker(const AskedWorker& asked, std::uint32_t tasks,
                            const Variables& variables) {
  pipeline::Share worker =
      asked.index ? pipeline::Share{*asked.index, tasks} : of_environment(tasks, variables);
  if (asked.of)
    worker.of = *asked.of;
  if (worker.index >= worker.of) {
    throw Error(ErrorCode::usage, fmt::format("worker {} of {} cannot be: workers count from 0; "
                                              "give --index and --of",
                                              worker.index, worker.of));
  }
  return worker;
}

}  // namespace meshhier::app
