// A build cut into tasks, for engines that place, retry and watch them on many machines
// (docs/cluster.md). No task talks to another: each reads what those before it have sealed
// (storage/format/segment.h) in a directory that all machines see.
//
// These are the stages, in their order, which follow from task_kinds() (pipeline/stages.cpp). The
// plan says how many `N` is.
//
//   stage             tasks   makes
//   read              1       splits of the mesh; all chunks of an input that has no slices
//   distribute        N       vertices of the chunks, of slices of the input
//   faces             N       triangles of the chunks, likewise
//   join              1       triangles that no slice could take, and what all learnt of the input
//   leaves            N       partitions, of runs of chunks
//   level-1 ...       N       simplified tiles of one level of the tree, the finest first
//   top               1       those of all levels that have fewer nodes than N
//   images            1       decoded pictures                                 textured meshes
//   texture-0 ...     N       pictures of partitions, and of the levels above  textured meshes
//   texture-top       1       those of the levels of `top`                     textured meshes
//   publish           N       the tiles' files
//   finish            1       all other files, and the hierarchy's name
//
// The depth of the tree can be unknown until the input is read: the stages are those of the deepest
// that can be, and tasks that turn out to have nothing to do end at once.
#pragma once

#include "config/config.h"
#include "pipeline/plan/stage_context.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::pipeline {

struct TaskKind;

/// The most tasks that a stage is cut into.
inline constexpr std::uint32_t kMostTasks = 65536;

struct TaskPlan {
  config::Config config;          ///< paths are absolute
  bool replace = false;           ///< an existing output
  std::uint32_t tasks = 1;        ///< in each stage that is cut
  std::uint32_t levels = 0;       ///< stages level-1, level-2 ...
  bool textured = false;          ///< whether the mesh may have textures
  std::string program;            ///< the program that made it: only that goes on with it
  std::uint64_t fingerprint = 0;  ///< identifies all this, but for memory and threads
};

struct TaskStage {
  std::string name;
  const TaskKind* kind = nullptr;  ///< a row of task_kinds()
  std::uint32_t tasks = 1;
  std::uint32_t levels_up = 0;  ///< from the partitions, if its kind is cut by levels
};

/// Returns the stages in the order in which they are to run: each when all tasks of those before it
/// are done.
std::vector<TaskStage> stages_of(const TaskPlan& plan);

/// Returns the stage of that name. Throws Error(usage) that names the stages if there is none.
TaskStage find_stage(const TaskPlan& plan, std::string_view name);

struct TaskPlanRequest {
  std::filesystem::path work;  ///< the directory that all machines see
  std::uint32_t tasks = 1;     ///< 1 to kMostTasks
  bool replace = false;
  std::string program;  ///< the same text for programs of the same source and compiler
};

/// Refuses what a build would refuse, as far as it is known from the input's header, and writes the
/// plan; nothing happens if it is there already. Throws Error(other_work) if `work` has another
/// plan, Error(exists) if it has other files, Error(usage) if it lies in the output, or that in it,
/// or on another file system.
TaskPlan make_task_plan(const config::Config& config, const TaskPlanRequest& request,
                        const BuildEnvironment& environment);

/// Reads the plan. Throws Error(usage) if there is none, Error(other_work) if another program made
/// it, Error(corrupt) if it is damaged, Error(io).
TaskPlan read_task_plan(storage::FileSystem& files, const std::filesystem::path& work,
                        const std::string& program);

}  // namespace meshhier::pipeline
