// How far a build in tasks is, from its sealed segments alone.
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
  std::uint64_t bytes = 0;             ///< of segments
  double wall_seconds = 0;             ///< of the tasks that are done, one after another
  double longest_seconds = 0;          ///< of one of them
  double cpu_seconds = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;  ///< by the tasks that are done
  std::uint64_t peak_resident_bytes = 0;            ///< of the largest
};

struct TaskStatus {
  std::vector<StageStatus> stages;  ///< in their order
  bool is_finished = false;         ///< and the output named; other segments are gone then
  std::uint32_t attempts = 0;       ///< tasks at work, or killed
  EarlierBuild source;              ///< known when `read` is done, its counts when `join` is
};

/// Throws Error(io).
TaskStatus task_status(const TaskPlan& plan, const std::filesystem::path& work,
                       storage::FileSystem& files);

/// CPU seconds that the tasks which are not done may take, from what the others took; none until
/// the input is read, or if its pictures cannot be.
std::optional<double> cpu_seconds_left(const TaskStatus& status, const TaskPlan& plan,
                                       storage::FileSystem& files);

/// The first stage that is not complete; null if all is done.
const StageStatus* next_stage(const TaskStatus& status);

/// `left`: cpu_seconds_left().
std::string status_text(const TaskStatus& status, const TaskPlan& plan, std::optional<double> left);
nlohmann::ordered_json status_json(const TaskStatus& status, const TaskPlan& plan,
                                   std::optional<double> left);

}  // namespace meshhier::pipeline
