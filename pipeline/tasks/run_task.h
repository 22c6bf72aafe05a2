// One task of a build on many machines: the stages of a build (pipeline/build.h), each for a part
// of its nodes, between what other tasks have sealed and a segment of its own.
//
// A task may be killed at any moment, run twice, or run at once with itself: its result gets its
// name when it is whole and on disk, and is the same bytes of data whoever made it.
#pragma once

#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tasks/task_plan.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::pipeline {

struct TaskRequest {
  std::filesystem::path work;  ///< the plan's directory
  std::string stage;
  Share worker{};                   ///< does the tasks index, index + of ... of the stage
  std::filesystem::path scratch;    ///< a directory on this machine for unsealed files; or empty
  std::uint32_t threads = 0;        ///< 0: as the plan's config says
  std::uint64_t memory_budget = 0;  ///< bytes; 0: likewise
  std::string program;              ///< as for make_task_plan()
};

struct TaskReport {
  std::uint32_t done = 0;   ///< tasks that were done now
  std::uint32_t found = 0;  ///< tasks that were done before
  std::string text;         ///< for people: the result of `finish`; else empty
};

/// Does the worker's tasks one after another. Throws Error(io) if a stage before is not complete,
/// naming the task that is missing, Error(corrupt) if one of its segments is damaged, and what the
/// stage itself may throw; nothing that was sealed is lost then.
TaskReport run_tasks(const TaskRequest& request, const BuildEnvironment& environment);

}  // namespace meshhier::pipeline
