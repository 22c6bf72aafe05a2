// The end of a build in tasks: the files that say something of all tiles, and the hierarchy's name.
#pragma once

#include "pipeline/journal/workshop.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tasks/task_plan.h"
#include "storage/format/segment.h"
#include "storage/format/work_directory.h"

#include <filesystem>
#include <string>

namespace meshhier::pipeline {

/// Completes the hierarchy in `work`, or its archive: makes the files that a task of that kind
/// does, and notes the result in `entries`. Requires that all tiles are published; reads them all.
/// `tasks`: their number in the stage `publish`. Throws Error(corrupt) that names the task to run
/// again if a tile is missing or not what was published.
void finish_hierarchy(const TaskKind& kind, Workshop& workshop, const std::filesystem::path& work,
                      std::uint32_t tasks, storage::SegmentWriter& entries,
                      const StageContext& context);

/// Gives the finished hierarchy the output's name and removes the segments, unless that is done
/// already. Returns a text on the output, for people. Throws Error(exists) as check_output() does,
/// Error(corrupt) if the finished hierarchy is gone.
std::string name_hierarchy(const TaskPlan& plan, storage::WorkDirectory& shared,
                           storage::FileSystem& files);

/// Whether name_hierarchy() has done that. Throws Error(io).
bool is_named(const TaskPlan& plan, const std::filesystem::path& work, storage::FileSystem& files);

}  // namespace meshhier::pipeline
