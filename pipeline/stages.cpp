// To add a stage: write its files, and give it a row in kStages; to cut it into tasks of its own,
// name them there and give them rows in kTaskKinds. If it can be resumed, the journal gets a kind
// of entry (journal/build_journal.cpp).
#include "pipeline/stages.h"

#include "execution/threads.h"
#include "pipeline/account_stage.h"
#include "pipeline/images_stage.h"
#include "pipeline/import_stage.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/leaves_stage.h"
#include "pipeline/normal_map_stage.h"
#include "pipeline/object_stage.h"
#include "pipeline/pack_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/simplify_stage.h"
#include "pipeline/stage_costs.h"
#include "pipeline/tasks/input_slices.h"
#include "pipeline/texture_stage.h"
#include "storage/format/layout.h"

#include <algorithm>
#include <array>

namespace meshhier::pipeline {
namespace {

bool has_pictures(const JobSize& job) {
  return job.textured;
}

/// Checks the disk by the partitions, which tell what it needs. Without the chunks they cannot be
/// made again, so they reach the disk before those go.
void settle_leaves(Making& of, const StageContext& context) {
  Workshop& workshop = of.workshop;
  if (const auto refined = refine_disk(context.plan, workshop.forest.partition_sums())) {
    of.disk = *refined;
    check_disk(of.disk, context.config.output, context.files);
  }
  of.settled = execution::run_beside([&workshop, &context] {
    workshop.tile_scratch.sync([&] { context.cancel.check(); });
    workshop.journal.sync();
    workshop.mesh_scratch.remove();
  });
}

/// Checks the disk by the normals, which tell how many vertices are split.
void settle_tiles(Making& of, const StageContext& context) {
  of.settled.get();
  if (const std::uint64_t splits = of.workshop.forest.split_count(); splits > 0) {
    of.disk = with_splits(context.plan, of.disk, splits);
    check_disk(of.disk, context.config.output, context.files);
  }
}

void make_tile_textures(Making& of, const LevelRange& part, const StageContext& context) {
  if (part.top == part.end)
    return;
  Workshop& workshop = of.workshop;
  const images::MaterialList materials = shown_materials(context.plan.textures, workshop.journal);
  make_textures(workshop.forest, {materials, workshop.pictures}, workshop.textures,
                workshop.journal, part, context);
}

StageTimes sync_time(const JobSize& job, const TilePopulation& tiles) {
  return {{"sync", "bytes", 0, published_bytes(job, tiles) / kDiskBytesPerSecond}};
}

// Parts of the time of `partition`: the sweep for the splits, vertices, and twice as many
// triangles.
constexpr double kSweep = 0.25, kVertices = 0.25, kTriangles = 0.5;

constexpr std::array kStages{
    // input → one PLY
    Stage{.name = "import", .disk = imported_disk, .tasks = {{kReadTask}}},
    // PLY → bounds, origin, a sample; vertices once more if they are not in place
    Stage{.name = "ingest",
          .memory = ingest_memory,
          .disk = ingest_disk,
          .time = ingest_time,
          .tasks = {{kReadTask}},
          .notes = {"ingest"}},
    // PLY → chunks
    Stage{.name = "partition",
          .memory = partition_memory,
          .disk = partition_disk,
          .time = partition_time,
          .tasks =
              {{kReadTask, kSweep}, {"distribute", kVertices}, {"faces", kTriangles}, {"join", 0}},
          .notes = {"partition"}},
    // pictures of the input → decoded pictures
    Stage{.name = "images",
          .applies = has_pictures,
          .memory = images_memory,
          .disk = images_disk,
          .time = images_time,
          .make =
              [](Making& of, auto&, auto& context) {
                decode_images(of.workshop.pictures, of.workshop.journal, context);
              },
          .tasks = {{kImagesTask}},
          .notes = {"image"}},
    // chunks → partition tiles
    Stage{.name = "leaves",
          .memory = leaves_memory,
          .disk = leaves_disk,
          .time = leaves_time,
          .check =
              [](Making& of, auto& part, auto& context) {
                check_chunks(of.workshop.chunks, part.share, context.cancel);
              },
          .make =
              [](Making& of, auto& part, auto& context) {
                Workshop& at = of.workshop;
                make_leaves(at.chunks, at.forest, at.journal, part.share, context);
              },
          .then = settle_leaves,
          .tasks = {{"leaves"}},
          .notes = {"leaves"}},
    // tiles of a level → simplified tiles of the one above, with maps to them, and normals
    Stage{.name = "simplify",
          .memory = simplify_memory,
          .disk = simplify_disk,
          .time = simplify_time,
          .make =
              [](Making& of, auto& part, auto& context) {
                Workshop& at = of.workshop;
                simplify(at.forest, at.journal, at.journal.source()->summary.attributes, part,
                         context);
              },
          .then = settle_tiles,
          .tasks = {{"level"}, {"top"}},
          .notes = {"simplify", "root"}},
    // tiles and decoded pictures → a picture a tile, with a normal map of a simplified one if asked
    // for
    Stage{.name = "texture",
          .applies = has_pictures,
          .memory = texture_memory,
          .disk = texture_disk,
          .time = texture_time,
          .make = make_tile_textures,
          .then = [](Making& of, auto&) { of.workshop.picture_scratch.remove(); },
          .tasks = {{"texture"}, {"texture-top"}},
          .notes = {"texture"}},
    // tiles → a normal map a simplified tile
    Stage{.name = "normal maps",
          .applies = [](const JobSize& job) { return job.normal_map_side > 0 && !job.textured; },
          .memory = normal_map_memory,
          .disk = normal_map_disk,
          .time = normal_map_time,
          .make =
              [](Making& of, auto& part, auto& context) {
                Workshop& at = of.workshop;
                make_normal_maps(at.forest, at.textures, at.journal, part, context);
              },
          .tasks = {{"texture"}, {"texture-top"}},
          .notes = {"texture"}},
    // tiles of one level → lines
    Stage{.name = "outline",
          .time = outline_time,
          .make =
              [](Making& of, auto&, auto& context) {
                const SourceSummary& source = of.workshop.journal.source()->summary;
                of.outline = make_outline(of.workshop.forest, source.diagonal(), context);
              },
          .tasks = {{kFinishTask}}},
    // tiles, their pictures and maps → their files
    Stage{.name = "publish",
          .memory = publish_memory,
          .disk = publish_disk,
          .time = publish_time,
          .make =
              [](Making& of, auto& part, auto& context) {
                Workshop& at = of.workshop;
                publish(at.forest, at.textures, at.journal, of.to, part.share, at.tile_scratch,
                        context);
              },
          .tasks = {{kPublishTask}},
          .notes = {"publish"}},
    // tiles → what is known of each object
    Stage{.name = "objects",
          .applies = [](const JobSize& job) { return job.has_objects; },
          .time = objects_time,
          .make =
              [](Making& of, auto&, auto& context) {
                Workshop& at = of.workshop;
                const auto work = of.to.directory.parent_path();
                of.objects = make_objects(at.forest, at.journal.source()->origin,
                                          storage::imported_objects_path(work), of.to.directory,
                                          at.tile_scratch, context);
              },
          .tasks = {{kFinishTask}}},
    // lines, and what is known of all tiles → all other files
    Stage{.name = "account",
          .make =
              [](Making& of, auto&, auto& context) {
                Workshop& at = of.workshop;
                write_account(at.forest, at.textures, at.journal, of.outline, of.objects,
                              of.to.directory, context);
              },
          .tasks = {{kFinishTask}}},
    // all files → an archive
    Stage{.name = "pack",
          .applies = [](const JobSize& job) { return job.packed; },
          .disk_time = pack_time},
    Stage{.name = "sync", .disk_time = sync_time},
};

constexpr auto kMesh = &Workshop::mesh_scratch;
constexpr auto kPictures = &Workshop::picture_scratch;
constexpr auto kTiles = &Workshop::tile_scratch;

constexpr std::array kTaskKinds{
    TaskKind{kReadTask, TaskCut::whole, Takes::nothing, kMesh},
    TaskKind{"distribute", TaskCut::shares, Takes::slices, kMesh, 0, false,
             &InputSlices::distribute},
    TaskKind{"faces", TaskCut::shares, Takes::slices, kMesh, 0, false, &InputSlices::take_faces},
    TaskKind{"join", TaskCut::whole, Takes::slices, kMesh, 0, false, &InputSlices::join},
    TaskKind{"leaves", TaskCut::shares, Takes::chunks, kTiles},
    TaskKind{"level", TaskCut::levels, Takes::level, kTiles, 1},
    TaskKind{"top", TaskCut::top, Takes::tiles, kTiles, 1},
    TaskKind{kImagesTask, TaskCut::whole, Takes::input, kPictures, 0, true},
    TaskKind{"texture", TaskCut::levels, Takes::pictures, kTiles, 0, true},
    TaskKind{"texture-top", TaskCut::top, Takes::pictures, kTiles, 0, true},
    TaskKind{kPublishTask, TaskCut::shares, Takes::tiles, kTiles},
    TaskKind{kFinishTask, TaskCut::whole, Takes::tiles, kTiles},
};

}  // namespace

std::span<const Stage> stages() {
  return kStages;
}

std::span<const TaskKind> task_kinds() {
  return kTaskKinds;
}

std::vector<const Stage*> stages_of(const JobSize& job) {
  std::vector<const Stage*> those;
  for (const Stage& stage : kStages) {
    if (stage.applies(job))
      those.push_back(&stage);
  }
  return those;
}

void make_stages(const TaskKind& kind, Making& of, const LevelRange& part,
                 const StageContext& context) {
  const auto is_of_kind = [&](const TaskPart& one) { return one.task == kind.name; };
  for (const Stage* stage : stages_of(context.plan.job)) {
    if (stage->make == nullptr || std::ranges::none_of(stage->tasks, is_of_kind))
      continue;
    if (stage->check != nullptr)
      stage->check(of, part, context);
    stage->make(of, part, context);
  }
}

}  // namespace meshhier::pipeline
