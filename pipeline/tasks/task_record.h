// What tasks say of themselves and of each other.
#pragma once

#include "hierarchy/error.h"
#include "pipeline/plan/build_stats.h"
#include "storage/format/segment.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// What a task took; not in it: reading the plan, and sealing.
struct TaskCost {
  double wall_seconds = 0;
  double cpu_seconds = 0;
  std::uint64_t peak_resident_bytes = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
};

/// The last entry of a segment.
nlohmann::json took_entry(const StageStats& total);
/// None if it is no such entry.
std::optional<TaskCost> task_cost(const nlohmann::json& entry);

/// Throws missing_task() if there is none, and as Segment::open().
std::unique_ptr<storage::Segment> open_segment(storage::FileSystem& files,
                                               const std::filesystem::path& work,
                                               const storage::SegmentName& name);

/// Each says which task to run.
Error missing_task(const std::filesystem::path& work, const std::string& stage,
                   std::uint32_t index);
Error damaged_segment(const std::filesystem::path& work, const storage::SegmentName& name);

}  // namespace meshhier::pipeline
