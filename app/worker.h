// The part of a stage's tasks that a process does, from the variables that schedulers set.
#pragma once

#include "pipeline/plan/share.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace meshhier::app {

/// The worker that the command line asks for.
struct AskedWorker {
  std::optional<std::uint32_t> index, of;
};

/// Returns the value of a variable of the environment; nothing if it is not set.
using Variables = std::function<std::optional<std::string>(const char* name)>;
Variables process_environment();

/// Returns the worker of the command line, or else of a Slurm array or step, an Indexed Job of
/// Kubernetes, or an array of AWS Batch; without any, one that does all tasks. If the count is not
/// known, there are `tasks` workers: each does one. Throws Error(usage) for an index that is not
/// below the count, and for a variable that is no number.
pipeline::Share find_worker(const AskedWorker& asked, std::uint32_t tasks,
                            const Variables& variables);

}  // namespace meshhier::app
