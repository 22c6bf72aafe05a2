#include "pipeline/tasks/task_record.h"

#include "storage/format/layout.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/format.h>

namespace meshhier::pipeline {

nlohmann::json took_entry(const StageStats& total) {
  return {{"took",
           {{"wall_seconds", total.wall_seconds},
            {"cpu_seconds", total.cpu_seconds()},
            {"peak_resident_bytes", total.peak_resident_bytes},
            {"bytes_read", total.bytes.input_read + total.bytes.temporary_read},
            {"bytes_written", total.bytes.output_written + total.bytes.temporary_written}}}};
}

std::optional<TaskCost> task_cost(const nlohmann::json& entry) {
  if (!entry.contains("took"))
    return std::nullopt;
  const nlohmann::json& took = entry.at("took");
  return TaskCost{took.at("wall_seconds"), took.at("cpu_seconds"), took.at("peak_resident_bytes"),
                  took.at("bytes_read"), took.at("bytes_written")};
}

Error missing_task(const std::filesystem::path& work, const std::string& stage,
                   std::uint32_t index) {
  return {ErrorCode::io,
          fmt::format("task {} of stage {} is not done, and its result is needed: run "
                      "`meshhier task {} {} --index {}` first",
                      index, stage, work.string(), stage, index)};
}

Error damaged_segment(const std::filesystem::path& work, const storage::SegmentName& name) {
  return {ErrorCode::corrupt,
          fmt::format("{} is damaged: remove it, and run `meshhier task {} {} --index {}` again",
                      storage::segment_path(work, name).string(), work.string(), name.stage,
                      name.index)};
}

std::unique_ptr<storage::Segment> open_segment(storage::FileSystem& files,
                                               const std::filesystem::path& work,
                                               const storage::SegmentName& name) {
  // A network file system may remember that a name was not there; its directory tells better.
  constexpr int kTries = 20;
  constexpr std::chrono::milliseconds kPause(250);
  const std::filesystem::path path = storage::segment_path(work, name);
  for (int i = 0; i < kTries; ++i) {
    if (auto segment = storage::Segment::open(files, work, name))
      return segment;
    const auto there = files.children(storage::segments_path(work));
    if (!std::ranges::binary_search(there, path))
      break;
    std::this_thread::sleep_for(kPause);
  }
  throw missing_task(work, name.stage, name.index);
}

}  // namespace meshhier::pipeline
