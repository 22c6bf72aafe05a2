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

/// Completes the hierarchy in `work`, or its archive, of which all tiles are published, by what a
/// task of that kind makes, and notes what it is in `entries`. Reads all tiles. `tasks`: of the
/// stage `publish`. Throws Error(corrupt) that names the task to run again if a tile is missing or
/// not what was published.
void finish_hierarchy(const TaskKind& kind, Workshop& workshop, const std::filesystem::path& work,
                      std::uint32_t tasks, storage::SegmentWriter& entries,
                      const StageContext& context);

/// Gives what was finished the output's name and removes what tasks have sealed, unless that is
/// done already. Returns what there is, for people. Throws Error(exists) as check_output() does,
/// Error(corrupt) if what was finished is gone.
std::string name_hierarchy(const TaskPlan& plan, storage::WorkDirectory& shared,
                           storage::FileSystem& files);

/// Whether that was done. Throws Error(io).
bool is_named(const TaskPlan& plan, const std::filesystem::path& work, storage::FileSystem& files);

}  // namespace meshhier::pipeline
