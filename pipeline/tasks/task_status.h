// The status of a build in tasks, from its sealed segments alone.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/tasks/task_plan.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

struct StageStatus {
  std::string name;
  std::uint32_t tasks = 1;
  std::uint32_t done = 0;
  std::vector<std::uint32_t> damaged;  ///< tasks whose segment is no use; they are not done
  std::uint64_t bytes = 0;             ///< all segments
  double wall_seconds = 0;             ///< sum over the tasks that are done
  double longest_seconds = 0;          ///< the longest of them
  double cpu_seconds = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;  ///< by the tasks that are done
  std::uint64_t peak_resident_bytes = 0;            ///< the largest of them
};

struct TaskStatus {
  std::vector<StageStatus> stages;  ///< in their order
  bool is_finished = false;         ///< and the output named; other segments are gone then
  std::uint32_t attempts = 0;       ///< tasks at work, or killed
  EarlierBuild source;              ///< known when `read` is done, its counts when `join` is
};

/// Reads the seals and entries of all segments, not their data. Throws Error(io).
TaskStatus task_status(const TaskPlan& plan, const std::filesystem::path& work,
                       storage::FileSystem& files);

/// Returns the CPU seconds that the tasks which are not done may take, from what the others took;
/// nothing until the input is read, or if its pictures cannot be.
std::optional<double> cpu_seconds_left(const TaskStatus& status, const TaskPlan& plan,
                                       storage::FileSystem& files);

/// Returns the first stage that is not complete; null if all is done.
const StageStatus* next_stage(const TaskStatus& status);

/// `left`: cpu_seconds_left().
std::string status_text(const TaskStatus& status, const TaskPlan& plan, std::optional<double> left);
nlohmann::ordered_json status_json(const TaskStatus& status, const TaskPlan& plan,
                                   std::optional<double> left);

}  // namespace meshhier::pipeline
