#include "pipeline/tasks/task_status.h"

#include "execution/size_text.h"
#include "hierarchy/error.h"
#include "hierarchy/plain_text.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/stage_costs.h"
#include "pipeline/tasks/finish_task.h"
#include "pipeline/tasks/task_record.h"
#include "storage/format/layout.h"
#include "storage/format/segment.h"

#include <algorithm>
#include <cmath>
#include <map>

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

/// `there`: the names in the directory. Looking for others, a network file system would remember
/// for a while that they were not there.
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

/// What each stage will take by the model that progress is told by (stage_costs.h), in CPU seconds.
std::map<std::string, double> expected_seconds(const TaskPlan& plan, const BuildPlan& build) {
  std::map<std::string, double> by_stage;
  for (const StageTime& stage : cpu_times(plan.config, build))
    by_stage[stage.name] += stage.seconds;
  std::map<std::string, double> by_task_stage;
  const Tree& tree = build.tree;
  // A level has half the tiles of the one below.
  const auto share = [&](std::uint32_t up) {
    return static_cast<int>(up) > raw(tree.depth()) ? 0 : std::ldexp(1.0, -static_cast<int>(up));
  };
  // Of the time of `partition`: a sweep, the vertices, and twice as many triangles.
  constexpr double kSweep = 0.25, kVertices = 0.25, kTriangles = 0.5;
  const double partition = by_stage["partition"];
  const double texture = by_stage["texture"] + by_stage["normal maps"];  // a mesh has one of them
  double rest = 1, texture_rest = 1;
  for (const TaskStage& stage : stages_of(plan)) {
    double& seconds = by_task_stage[stage.name];
    switch (stage.kind) {
      case TaskKind::read:
        for (const auto& [name, time] : by_stage) {
          if (name != "partition" && name != "leaves" && name != "simplify" && name != "texture" &&
              name != "normal maps" && name != "publish" && name != "outline" && name != "images")
            seconds += time;
        }
        seconds += partition * kSweep;
        break;
      case TaskKind::distribute:
        seconds = partition * kVertices;
        break;
      case TaskKind::faces:
        seconds = partition * kTriangles;
        break;
      case TaskKind::join:
        break;
      case TaskKind::leaves:
        seconds = by_stage["leaves"];
        break;
      case TaskKind::level:
        seconds = by_stage["simplify"] * share(stage.levels_up);
        rest -= share(stage.levels_up);
        break;
      case TaskKind::top:
        seconds = by_stage["simplify"] * rest;
        break;
      case TaskKind::images:
        seconds = by_stage["images"];
        break;
      case TaskKind::texture:
        seconds = texture * share(stage.levels_up + 1);
        texture_rest -= share(stage.levels_up + 1);
        break;
      case TaskKind::texture_top:
        seconds = texture * texture_rest;
        break;
      case TaskKind::publish:
        seconds = by_stage["publish"];
        break;
      case TaskKind::finish:
        seconds = by_stage["outline"];
        break;
    }
  }
  return by_task_stage;
}

std::uint32_t count_attempts(const std::filesystem::path& work, storage::FileSystem& files) {
  const std::filesystem::path attempts = storage::attempts_path(work);
  return files.exists(attempts) ? static_cast<std::uint32_t>(files.children(attempts).size()) : 0;
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
        plan_build(plan.config, description_of(status.source), 0,
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
