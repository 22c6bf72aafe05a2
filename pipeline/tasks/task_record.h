// Entries and errors in which tasks tell of themselves and of each other.
#pragma once

#include "base/error.h"
#include "pipeline/plan/build_stats.h"
#include "storage/format/segment.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// The costs of a task, without reading the plan and sealing.
struct TaskCost {
  double wall_seconds = 0;
  double cpu_seconds = 0;
  std::uint64_t peak_resident_bytes = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
};

/// Returns the last entry of a segment, which has them.
nlohmann::json took_entry(const StageStats& total);
/// Parses such an entry; returns nothing if it is none.
std::optional<TaskCost> task_cost(const nlohmann::json& entry);

/// Opens a segment; waits some seconds for a network file system to show it. Throws missing_task()
/// if there is none, and as Segment::open().
std::unique_ptr<storage::Segment> open_segment(storage::FileSystem& files,
                                               const std::filesystem::path& work,
                                               const storage::SegmentName& name);

/// Each returns an error that says which task to run.
Error missing_task(const std::filesystem::path& work, const std::string& stage,
                   std::uint32_t index);
Error damaged_segment(const std::filesystem::path& work, const storage::SegmentName& name);

}  // namespace meshhier::pipeline
