#include "pipeline/tasks/task_status.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/size_text.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/stage_costs.h"
#include "pipeline/stages.h"
#include "pipeline/tasks/finish_task.h"
#include "pipeline/tasks/task_record.h"
#include "storage/format/layout.h"
#include "storage/format/segment.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// Adds a sealed segment; `source` takes what the stage `read` noted.
void add_segment(storage::Segment& segment, StageStatus& stage, EarlierBuild& source) {
  segment.for_each([&](const storage::EntrySink::Entry& entry) {
    add_entry(entry, source);
    const std::optional<TaskCost> cost = task_cost(entry);
    if (!cost)
      return true;
    stage.wall_seconds += cost->wall_seconds;
    stage.longest_seconds = std::max(stage.longest_seconds, cost->wall_seconds);
    stage.cpu_seconds += cost->cpu_seconds;
    stage.bytes_read += cost->bytes_read;
    stage.bytes_written += cost->bytes_written;
    stage.peak_resident_bytes = std::max(stage.peak_resident_bytes, cost->peak_resident_bytes);
    return true;
  });
  ++stage.done;
  stage.bytes += segment.take_file()->size();
}

/// `there`: the names in the directory. Others are not looked for, as a network file system would
/// remember for a while that they were not there.
StageStatus stage_status(const TaskPlan& plan, const TaskStage& stage,
                         const std::filesystem::path& work,
                         const std::vector<std::filesystem::path>& there,
                         storage::FileSystem& files, EarlierBuild& source) {
  StageStatus status{.name = stage.name, .tasks = stage.tasks, .damaged = {}};
  for (std::uint32_t i = 0; i < stage.tasks; ++i) {
    const storage::SegmentName name{plan.fingerprint, stage.name, i};
    if (!std::ranges::binary_search(there, storage::segment_path(work, name)))
      continue;
    try {
      if (const auto segment = storage::Segment::open(files, work, name))
        add_segment(*segment, status, source);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::corrupt)
        throw;
      status.damaged.push_back(i);
    } catch (const nlohmann::json::exception&) {
      status.damaged.push_back(i);
    }
  }
  return status;
}

/// Returns the part of a kind's time that the tasks of one of its stages take, in a tree of that
/// depth: a level has half the tiles of the one below.
double part_of(const TaskStage& stage, const TaskPlan& plan, int depth) {
  const auto halvings = [&](std::uint32_t levels_up) {
    return static_cast<int>(levels_up + 1 - stage.kind->first_level);
  };
  if (stage.kind->cut == TaskCut::top)
    return std::ldexp(1.0, -std::min(halvings(plan.levels), depth));
  if (stage.kind->cut != TaskCut::levels)
    return 1;
  const int own = halvings(stage.levels_up);
  return own > depth ? 0 : std::ldexp(1.0, -own);
}

/// Returns the CPU seconds that each stage will take by the model of stage_costs.h.
std::map<std::string, double> expected_seconds(const TaskPlan& plan, const BuildPlan& build) {
  const TilePopulation tiles = expected_tiles(build.job);
  std::map<std::string_view, double> by_kind;
  for (const Stage* stage : stages_of(build.job)) {
    if (stage->time == nullptr)
      continue;
    for (const StageTime& pass : stage->time(build.job, tiles)) {
      for (const TaskPart& part : stage->tasks)
        by_kind[part.task] += part.time * pass.seconds;
    }
  }
  std::map<std::string, double> by_stage;
  for (const TaskStage& stage : stages_of(plan))
    by_stage[stage.name] =
        by_kind[stage.kind->name] * part_of(stage, plan, raw(build.tree.depth()));
  return by_stage;
}

std::uint32_t count_attempts(const std::filesystem::path& work, storage::FileSystem& files) {
  try {
    return static_cast<std::uint32_t>(files.children(storage::attempts_path(work)).size());
  } catch (const storage::NotThere&) {  // `finish` has removed them
    return 0;
  }
}

}  // namespace

TaskStatus task_status(const TaskPlan& plan, const std::filesystem::path& work,
                       storage::FileSystem& files) {
  TaskStatus status;
  const std::filesystem::path segments = storage::segments_path(work);
  std::vector<std::filesystem::path> there;
  if (files.exists(segments))
    there = files.children(segments);
  for (const TaskStage& stage : stages_of(plan))
    status.stages.push_back(stage_status(plan, stage, work, there, files, status.source));
  status.is_finished = is_named(plan, work, files);
  if (!status.is_finished)
    status.stages.back().done = 0;  // the output has not got its name
  status.attempts = count_attempts(work, files);
  return status;
}

std::optional<double> cpu_seconds_left(const TaskStatus& status, const TaskPlan& plan,
                                       storage::FileSystem& files) {
  if (!status.source.is_whole || status.is_finished)
    return std::nullopt;
  try {
    const BuildPlan build =
        plan_build(plan.config, description_of(status.source), {},
                   plan_textures(status.source.materials, config::MissingImages::ignore, files));
    const auto expected = expected_seconds(plan, build);
    double took = 0, expected_done = 0, left = 0;
    for (const StageStatus& stage : status.stages) {
      const double whole = expected.at(stage.name);
      const double done = whole * stage.done / stage.tasks;
      took += stage.cpu_seconds;
      expected_done += done;
      left += whole - done;
    }
    return expected_done > 0 ? left * took / expected_done : left;
  } catch (const Error&) {  // too little memory for this machine's share, a picture that is gone
    return std::nullopt;
  }
}

const StageStatus* next_stage(const TaskStatus& status) {
  const auto next = std::ranges::find_if(
      status.stages, [](const StageStatus& stage) { return stage.done < stage.tasks; });
  return status.is_finished || next == status.stages.end() ? nullptr : &*next;
}

std::string status_text(const TaskStatus& status, const TaskPlan& plan,
                        std::optional<double> left) {
  if (status.is_finished)
    return fmt::format("finished: {}\n", plain_text(plan.config.output.string(), 4096));
  std::string text =
      "stage           tasks    done       bytes    CPU time     longest      memory\n";
  for (const StageStatus& stage : status.stages) {
    text += fmt::format("{:<14} {:>6} {:>7}", stage.name, stage.tasks, stage.done);
    if (stage.done > 0) {
      text += fmt::format(" {:>11} {:>11} {:>11} {:>11}", execution::rounded_size_text(stage.bytes),
                          execution::duration_text(stage.cpu_seconds),
                          execution::duration_text(stage.longest_seconds),
                          execution::rounded_size_text(stage.peak_resident_bytes));
    }
    text += '\n';
    for (const std::uint32_t task : stage.damaged)
      text +=
          fmt::format("  the segment of task {} is damaged: the task is to be run again\n", task);
  }
  if (status.attempts > 0)
    text += counted(status.attempts, "tasks") + " at work, or killed\n";
  if (left)
    text += fmt::format("about {} of CPU time left\n", execution::duration_text(*left));
  if (const StageStatus* next = next_stage(status))
    text += fmt::format("next: stage {}\n", next->name);
  return text;
}

Json status_json(const TaskStatus& status, const TaskPlan& plan, std::optional<double> left) {
  Json stages = Json::array();
  for (const StageStatus& stage : status.stages) {
    stages.push_back({{"name", stage.name},
                      {"tasks", stage.tasks},
                      {"done", stage.done},
                      {"damaged", stage.damaged},
                      {"bytes", stage.bytes},
                      {"wall_seconds", stage.wall_seconds},
                      {"longest_seconds", stage.longest_seconds},
                      {"cpu_seconds", stage.cpu_seconds},
                      {"bytes_read", stage.bytes_read},
                      {"bytes_written", stage.bytes_written},
                      {"peak_resident_bytes", stage.peak_resident_bytes}});
  }
  const StageStatus* const next = next_stage(status);
  return {{"output", plan.config.output.string()},
          {"finished", status.is_finished},
          {"next", next != nullptr ? Json(next->name) : Json()},
          {"cpu_seconds_left", left ? Json(*left) : Json()},
          {"attempts", status.attempts},
          {"stages", stages}};
}

}  // namespace meshhier::pipeline
