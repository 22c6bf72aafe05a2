#include "pipeline/tasks/task_plan.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "config/partition_size.h"
#include "import/mesh_input.h"
#include "pipeline/import_stage.h"
#include "pipeline/stage_costs.h"
#include "pipeline/stages.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/hash.h"
#include "storage/io/json_text.h"
#include "storage/io/paths.h"
#include "storage/io/process.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace meshhier::pipeline {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int kPlanVersion = 1;
constexpr std::uint32_t kDeepest = 64;
constexpr std::size_t kLongestProgram = 80;
constexpr std::uint64_t kLargestPlanBytes = std::uint64_t{1} << 24;

std::uint64_t checksum_of(const std::string& text) {
  return storage::checksum(std::as_bytes(std::span(text)));
}

Json json_of(const TaskPlan& plan) {
  return {{"meshhier_task_plan", kPlanVersion},
          {"program", plan.program},
          {"tasks", plan.tasks},
          {"levels", plan.levels},
          {"textured", plan.textured},
          {"replace", plan.replace},
          {"config", storage::parse_ordered_json_text(
                         config::complete_text(plan.config, fs::current_path()))}};
}

std::string text_of(const TaskPlan& plan) {
  return storage::json_text(json_of(plan), {.indent = 2}) + '\n';
}

/// Returns the fingerprint. Keys that do not decide the result may change from one plan to the
/// next.
std::uint64_t fingerprint_of(const TaskPlan& plan) {
  Json json = json_of(plan);
  for (const char* key : {"memory_budget", "threads"})
    json["config"].erase(key);
  json.erase("replace");
  return checksum_of(storage::json_text(json));
}

Error not_a_plan(const fs::path& path) {
  return {ErrorCode::corrupt, path.string() + " is not what `meshhier plan` writes"};
}

TaskPlan parse_plan(const std::string& text, const fs::path& path) {
  try {
    const Json json = storage::parse_ordered_json_text(text);
    if (json.at("meshhier_task_plan") != kPlanVersion)
      throw Error(ErrorCode::corrupt, path.string() + " is a plan of another version");
    const auto number = [&](const char* key, std::uint32_t most) {
      const Json& value = json.at(key);
      if (!value.is_number_unsigned() || value.get<std::uint64_t>() > most)
        throw not_a_plan(path);
      return value.get<std::uint32_t>();
    };
    TaskPlan plan;
    plan.program = json.at("program");
    plan.tasks = number("tasks", kMostTasks);
    plan.levels = number("levels", kDeepest);
    plan.textured = json.at("textured");
    plan.replace = json.at("replace");
    plan.config =
        config::parse_config(storage::json_text(json.at("config")), {path.string(), {}}, {});
    plan.fingerprint = fingerprint_of(plan);
    if (plan.tasks == 0)
      throw not_a_plan(path);
    return plan;
  } catch (const Json::exception&) {
    throw not_a_plan(path);
  }
}

/// Returns an upper bound of the vertices of an input that must be read to count them.
std::uint64_t most_vertices(const importing::MeshInput& input) {
  constexpr std::uint64_t kBestPacking =
      1032;  // deflate's; no format has less than a byte a vertex
  std::uint64_t most = 1;
  for (const importing::InputFileFacts& file : input.files().all())
    most += file.identity.bytes * (file.format.is_gzip ? kBestPacking : 1);
  return most;
}

/// Returns how many levels above the partitions are cut in the deepest tree that may come out.
std::uint32_t most_levels(const config::Config& config, std::uint64_t vertices,
                          std::uint64_t least_partition, std::uint32_t tasks) {
  const std::uint64_t partitions = config.partition.count
                                       ? std::uint64_t{*config.partition.count}
                                       : (vertices + least_partition - 1) / least_partition;
  const auto depth = static_cast<std::uint32_t>(std::bit_width(
      std::max<std::uint64_t>(std::min<std::uint64_t>(partitions, std::uint64_t{1} << 31), 1) - 1));
  const auto top = static_cast<std::uint32_t>(std::bit_width(tasks - 1U));
  return depth > top ? depth - top : 0;
}

/// Returns how many levels the tree may have that are cut.
std::uint32_t count_levels(const config::Config& config, const importing::MeshInput& input,
                           std::uint32_t tasks) {
  if (!is_read_before_plan(input, config))
    return most_levels(config, input.description().places(), config.partition.vertices, tasks);
  // Partitions are the smaller, the more texels a vertex has.
  const std::uint64_t least = input.needs_import() && config.texture.use
                                  ? config::partition_vertices(config, 1, std::uint64_t{1} << 40)
                                  : config.partition.vertices;
  const std::uint64_t vertices =
      input.needs_import() ? most_vertices(input) : input.description().vertex_count;
  return most_levels(config, vertices, std::max<std::uint64_t>(least, 1), tasks);
}

/// Whether there is anything but what a `plan` leaves that was killed.
bool has_foreign_files(const fs::path& work, storage::FileSystem& files) {
  const fs::path attempts = storage::attempts_path(work);
  const fs::path segments = storage::segments_path(work);
  const auto is_foreign = [&](const fs::path& path) {
    if (path == segments)
      return !files.children(path).empty();
    if (storage::is_unique_name(path.filename().string()))
      return false;
    return path != attempts || !std::ranges::all_of(files.children(path), [](const fs::path& one) {
             return storage::is_unique_name(one.filename().string());
           });
  };
  return std::ranges::any_of(files.children(work), is_foreign);
}

/// Throws if files of others are in `work`, as `finish` removes all that is there. Where another
/// process has planned meanwhile, write_plan() looks at its plan.
void check_work(const fs::path& work, const fs::path& output, storage::FileSystem& files) {
  const fs::path place = files.canonical(work);
  const fs::path made = files.canonical(output);
  if (storage::is_within(made, place) || storage::is_within(place, made)) {
    throw Error(ErrorCode::usage, fmt::format("the directory {} and the output {} must lie apart",
                                              work.string(), output.string()));
  }
  if (files.exists(work) && has_foreign_files(work, files) &&
      !files.exists(storage::task_plan_path(work))) {
    throw Error(ErrorCode::exists, fmt::format("{} is not empty, and has no plan; choose a new "
                                               "directory",
                                               work.string()));
  }
}

/// Throws what a build would refuse before it reads more than a header.
void check_build(const config::Config& config, bool replace, const importing::MeshInput& input,
                 storage::FileSystem& files) {
  check_apart(config, files);
  storage::check_output(files, {config.output, config.storage.container}, replace);
  storage::check_place(files, config.output);
  if (is_read_before_plan(input, config))
    check_import_disk(import_disk(input, config), config.output, files);
  else
    check_disk(plan_build(config, input.description()).disk, config.output, files);
}

TaskPlan load_plan(const fs::path& work, const std::string& program, storage::FileSystem& files) {
  const fs::path path = storage::task_plan_path(work);
  const auto bytes = storage::read_file(files, path, kLargestPlanBytes);
  TaskPlan plan = parse_plan({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
  if (plan.program != program) {
    throw Error(ErrorCode::other_work,
                fmt::format("{} was planned by another program ({}) than this one ({}): every "
                            "machine must run the same; to begin anew remove it",
                            work.string(), plain_text(plan.program, kLongestProgram), program));
  }
  return plan;
}

/// Whether the plan is there already. Throws Error(other_work) if another one is.
bool is_there(const TaskPlan& plan, const fs::path& work, storage::FileSystem& files) {
  if (!files.exists(storage::task_plan_path(work)))
    return false;
  if (load_plan(work, plan.program, files).fingerprint == plan.fingerprint)
    return true;
  throw Error(
      ErrorCode::other_work,
      fmt::format("{} holds another plan: remove it, or plan in another directory", work.string()));
}

/// Throws if the two lie on different file systems: tasks' results get their places by being
/// renamed.
void check_one_file_system(const fs::path& work, const fs::path& output,
                           storage::FileSystem& files) {
  const fs::path name = storage::unique_name();
  const fs::path from = storage::attempts_path(work) / name;
  const fs::path to = storage::existing_directory(files, output) / ("." + name.string());
  storage::write_file(files, from, {});
  try {
    files.rename(from, to);
  } catch (const Error& error) {
    files.remove_all(from);
    if (!files.why_not_writable(to.parent_path()).empty())
      throw;
    throw Error(ErrorCode::usage,
                fmt::format("{} must be on the file system of the output {}, where files can be "
                            "renamed from one to the other: {}",
                            work.string(), output.string(), error.what()));
  }
  files.remove_all(to);
}

/// Writes the plan. One that is there is the same plan for other machines, and is replaced.
void write_plan(const TaskPlan& plan, const fs::path& work, storage::FileSystem& files) {
  const std::string text = text_of(plan);
  const fs::path attempt = work / storage::unique_name();
  {
    const auto file = files.create(attempt);
    file->write_at(0, std::as_bytes(std::span(text)));
    file->sync();
  }
  const fs::path path = storage::task_plan_path(work);
  if (!files.rename_new(attempt, path)) {
    try {
      is_there(plan, work, files);
    } catch (const Error&) {
      files.remove_all(attempt);
      throw;
    }
    files.rename(attempt, path);
  }
  files.sync_directory(work);
}

void make_directories(const fs::path& work, const fs::path& output, storage::FileSystem& files) {
  const bool is_new = !files.exists(work);
  files.make_directories(storage::attempts_path(work));
  files.make_directories(storage::segments_path(work));
  files.make_directories(output.parent_path());
  try {
    check_one_file_system(work, output, files);
  } catch (const Error&) {
    if (is_new)
      files.remove_all(work);
    throw;
  }
}

}  // namespace

std::vector<TaskStage> stages_of(const TaskPlan& plan) {
  std::vector<TaskStage> stages;
  for (const TaskKind& kind : task_kinds()) {
    if (kind.is_of_pictures && !plan.textured)
      continue;
    if (kind.cut == TaskCut::levels) {
      for (std::uint32_t k = kind.first_level; k <= plan.levels; ++k)
        stages.push_back({fmt::format("{}-{}", kind.name, k), &kind, plan.tasks, k});
      continue;
    }
    const std::uint32_t tasks = kind.cut == TaskCut::shares ? plan.tasks : 1;
    stages.push_back({std::string(kind.name), &kind, tasks});
  }
  return stages;
}

TaskStage find_stage(const TaskPlan& plan, std::string_view name) {
  std::vector<std::string> names;
  for (TaskStage& stage : stages_of(plan)) {
    if (stage.name == name)
      return std::move(stage);
    names.push_back(stage.name);
  }
  throw Error(ErrorCode::usage, fmt::format("the plan has no stage \"{}\"; its stages are: {}",
                                            name, fmt::join(names, ", ")));
}

TaskPlan make_task_plan(const config::Config& asked, const TaskPlanRequest& request,
                        const BuildEnvironment& environment) {
  storage::FileSystem& files = environment.files;
  TaskPlan plan;
  plan.config = config::parse_config(config::complete_text(asked, fs::current_path()), {}, {});
  plan.config.output = storage::followed(files, plan.config.output);
  plan.replace = request.replace;
  plan.tasks = request.tasks;
  plan.program = request.program;
  const importing::MeshInput input = open_input(plan.config, files);
  plan.textured = (input.needs_import() && plan.config.texture.use) ||
                  config::makes_maps(plan.config.storage.normals);
  plan.levels = count_levels(plan.config, input, request.tasks);
  plan.fingerprint = fingerprint_of(plan);
  if (is_there(plan, request.work, files)) {
    write_plan(plan, request.work, files);
    return plan;
  }
  check_work(request.work, plan.config.output, files);
  check_build(plan.config, plan.replace, input, files);
  make_directories(request.work, plan.config.output, files);
  write_plan(plan, request.work, files);
  return plan;
}

TaskPlan read_task_plan(storage::FileSystem& files, const fs::path& work,
                        const std::string& program) {
  if (!files.exists(storage::task_plan_path(work))) {
    throw Error(ErrorCode::usage,
                fmt::format("{} has no plan: `meshhier plan MESH --work {} --tasks N` makes one",
                            work.string(), work.string()));
  }
  return load_plan(work, program, files);
}

}  // namespace meshhier::pipeline
