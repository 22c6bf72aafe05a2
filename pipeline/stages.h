// The build as a table: its stages in their order, what each takes, what makes it, and which tasks
// of a build on many machines do it. Whoever needs one of these walks the rows (stages.cpp).
#pragma once

#include "pipeline/journal/workshop.h"
#include "pipeline/outline_stage.h"
#include "pipeline/plan/disk_need.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/stage_cost.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/publish_stage.h"
#include "storage/format/manifest.h"

#include <cstdint>
#include <future>
#include <span>
#include <string_view>
#include <vector>

namespace meshhier::pipeline {

class InputSlices;

/// Results that stages hand on, besides what they put into the workshop.
struct Making {
  Workshop& workshop;
  TileFiles to;                                      ///< where the tiles' files go
  DiskNeed disk{};                                   ///< the build's, as well as it is known
  OutlineStageResult outline{};                      ///< when it is made
  std::optional<storage::ObjectsSummary> objects{};  ///< likewise, if the mesh has any
  std::future<void> settled{};                       ///< when the partitions have reached the disk
};

/// The part of a stage's work that one kind of task does.
struct TaskPart {
  std::string_view task{};  ///< the kind's name
  double time = 1;          ///< the part of the stage's time that all its tasks take
};

/// A stage of a build. Functions that are null have nothing to do.
struct Stage {
  std::string_view name;  ///< progress and statistics call it so
  bool (*applies)(const JobSize& job) = [](const JobSize& /*job*/) { return true; };

  // The costs of the stage if it applies. Each function is beside the stage's code.
  StageMemory (*memory)(const JobSize& job) = nullptr;
  DiskVolumes (*disk)(const JobSize& job, const TilePopulation& tiles,
                      const MemoryPlan& memory) = nullptr;
  // Seconds of CPUs, and seconds that are spent waiting for the disk.
  StageTimes (*time)(const JobSize& job, const TilePopulation& tiles) = nullptr;
  StageTimes (*disk_time)(const JobSize& job, const TilePopulation& tiles) = nullptr;

  /// Throws if something is damaged that the stage needs and other processes have made.
  void (*check)(Making& of, const LevelRange& part, const StageContext& context) = nullptr;
  /// Makes the part in the workshop, but for what the journal has, and notes it: the share of its
  /// levels, or of all chunks or tiles. It may be stopped at any moment, by cancelling or a
  /// failure, and called again. It uses TBB's threads; the result depends on none of them. Null:
  /// the stage reads the input or ends the output, which is the driver's.
  void (*make)(Making& of, const LevelRange& part, const StageContext& context) = nullptr;
  /// Comes after make() on one machine: tells what is known now, and removes what is not needed any
  /// more.
  void (*then)(Making& of, const StageContext& context) = nullptr;

  TaskPart tasks[4]{};          ///< kinds that do it; the rest has no names
  std::string_view notes[2]{};  ///< entries of the journal, likewise
};

/// Returns the rows in the order of a build.
std::span<const Stage> stages();

/// Returns the rows that apply.
std::vector<const Stage*> stages_of(const JobSize& job);

/// Tells how many tasks of a kind there are, and which part of its stages each does.
enum class TaskCut {
  whole,   ///< one, all
  shares,  ///< as many as the plan says: a share of the input, the chunks or the tiles
  levels,  ///< likewise of each level that has so many nodes, from `first_level` above the last on
  top      ///< one, the levels above these
};

/// Tells what a task reads of those before it.
enum class Takes {
  nothing,   ///< it reads the input
  input,     ///< the facts that were learnt of the input
  slices,    ///< that, and all that was made of the input
  chunks,    ///< likewise, but only its share of the chunks
  level,     ///< these facts, and the tasks right before
  tiles,     ///< all but chunks
  pictures,  ///< likewise, and it looks at decoded pictures
};

/// A kind of task.
struct TaskKind {
  std::string_view name;  ///< its stage's; "NAME-1", "NAME-2" ... if there are several
  TaskCut cut{};
  Takes takes{};
  storage::ScratchFile Workshop::*scratch{};  ///< the file that its data goes to
  std::uint32_t first_level = 0;              ///< levels above the last
  bool is_of_pictures = false;                ///< there is none if the mesh can have no textures
  /// Does the work in the place of its stages' make(), unless it is null.
  void (InputSlices::*slice)(storage::EntrySink& entries) = nullptr;
};

inline constexpr std::string_view kReadTask = "read", kImagesTask = "images",
                                  kPublishTask = "publish", kFinishTask = "finish";

/// Returns the kinds in the order in which their tasks are to run.
std::span<const TaskKind> task_kinds();

/// Makes the part of one task: of all stages that tasks of its kind do. Throws what the stages
/// throw.
void make_stages(const TaskKind& kind, Making& of, const LevelRange& part,
                 const StageContext& context);

}  // namespace meshhier::pipeline
