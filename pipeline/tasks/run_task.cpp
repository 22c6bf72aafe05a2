#include "pipeline/tasks/run_task.h"

#include "base/error.h"
#include "execution/allocator.h"
#include "import/mesh_input.h"
#include "pipeline/import_stage.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/plan/build_stats.h"
#include "pipeline/read_stage.h"
#include "pipeline/stage_costs.h"
#include "pipeline/stages.h"
#include "pipeline/tasks/attempt.h"
#include "pipeline/tasks/finish_task.h"
#include "pipeline/tasks/input_slices.h"
#include "pipeline/tasks/task_record.h"
#include "storage/format/layout.h"
#include "storage/format/segment.h"
#include "storage/format/work_directory.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

namespace meshhier::pipeline {
namespace {

/// Throws Error(input) if a picture of the mesh is not what the stage `read` found.
void check_pictures(const importing::InputRecord& input, storage::FileSystem& files) {
  for (const importing::ReadFile& file : input.files) {
    if (file.part == importing::InputPart::picture && files.identity(file.path) != file.identity) {
      throw Error(ErrorCode::input,
                  fmt::format("{} was changed since the stage read: plan the build again",
                              file.path.string()));
    }
  }
}

/// One task, between segments.
class Task {
 public:
  Task(const TaskPlan& plan, const TaskStage& stage, std::uint32_t index,
       const TaskRequest& request, const BuildEnvironment& environment)
      : plan_(plan),
        stage_(stage),
        index_(index),
        work_(request.work),
        environment_(environment),
        pool_(0),
        meter_({environment.progress, environment.files.counters(), pool_.scratch_use()}),
        attempt_(environment.files, request.work, request.scratch) {}

  /// Does the task's work and seals it.
  void run() {
    if (stage_.kind->takes == Takes::nothing)
      read();
    else
      go_on();
  }

 private:
  storage::FileSystem& files() const { return environment_.files; }
  storage::SegmentName name(std::string_view stage, std::uint32_t index) const {
    return {plan_.fingerprint, std::string(stage), index};
  }

  void read();
  void go_on();
  /// Returns what the stage `read` noted, and finds out whether the input has slices. Throws
  /// Error(corrupt).
  EarlierBuild find_source();
  void open_workshop(const BuildPlan& plan, const BuildIdentity& identity,
                     const AttributeLayout& layout, const StageContext& context);
  /// Takes the results of the tasks before, as far as this one needs them.
  void mount_inputs();
  void mount(const TaskStage& stage);
  /// Takes an entry of a segment that is mounted. Returns false if it does not fit the plan.
  bool take(const storage::EntrySink::Entry& entry, std::uint32_t index);
  /// Whether the task needs the chunk of such an entry of the journal.
  bool needs_chunk(const storage::EntrySink::Entry& partition) const;
  bool is_slice() const { return stage_.kind->takes == Takes::slices; }
  /// Tells whether the task reads what tasks of a stage before have made. `is_next`: its own stage
  /// comes right behind that.
  bool needs(const TaskStage& before, bool is_next) const;

  void make(const StageContext& context);
  /// Returns the part of its stages that the task does; no levels if the tree is not so deep.
  LevelRange part() const;
  /// So many levels above the partitions are cut into tasks.
  int cut_levels() const;

  void seal();

  const TaskPlan& plan_;
  const TaskStage& stage_;
  std::uint32_t index_;
  std::filesystem::path work_;
  const BuildEnvironment& environment_;
  storage::MemoryPool pool_;
  StageMeter meter_;
  Attempt attempt_;
  storage::SegmentWriter* entries_ = nullptr;  ///< the journal's
  std::unique_ptr<Workshop> workshop_;
  bool has_slices_ = false;
  std::unique_ptr<InputSlices> slices_;    ///< only in stages that read them
  std::uint32_t last_faces_ = UINT32_MAX;  ///< slices behind this one have no triangles
};

void Task::open_workshop(const BuildPlan& plan, const BuildIdentity& identity,
                         const AttributeLayout& layout, const StageContext& context) {
  pool_.set_capacity(plan.memory.pool_bytes);
  auto entries = std::make_unique<storage::SegmentWriter>(name(stage_.name, index_));
  entries_ = entries.get();
  workshop_ = std::make_unique<Workshop>(attempt_.directory(), storage::built_path(work_), identity,
                                         layout, pool_, std::move(entries), context);
}

void Task::read() {
  const config::Config& config = plan_.config;
  importing::MeshInput input = open_input(config, files());
  const BuildEnvironment environment{files(), meter_, environment_.cancel};
  const std::filesystem::path objects = storage::imported_objects_path(attempt_.shared_directory());
  const BuildPlan plan =
      is_read_before_plan(input, config)
          ? read_and_plan(input, attempt_.directory(), objects, pool_, config, environment)
          : plan_build(config, input.description());
  check_apart(input.files().companions(), config, {}, files());
  check_coders(plan.job);
  check_disk(plan.disk, config.output, files());
  const StageContext context{config, plan, files(), meter_, environment_.cancel};
  meter_.expect(wall_times(plan));
  open_workshop(plan, identity_of(config, input, plan), input.description().attributes, context);
  if (const auto splits = read_splits(input, *workshop_, context))
    InputSlices::note(*splits, *entries_);
  if (input.objects()) {  // on the disk already
    files().rename(objects, storage::imported_objects_path(work_));
    files().sync_directory(work_);
  }
  seal();
}

EarlierBuild Task::find_source() {
  EarlierBuild source;
  const auto segment = open_segment(files(), work_, name(kReadTask, 0));
  segment->for_each([&](const storage::EntrySink::Entry& entry) {
    has_slices_ = has_slices_ || InputSlices::has_slices(entry);
    return add_entry(entry, source);
  });
  if (!source.is_whole)
    throw damaged_segment(work_, name(kReadTask, 0));
  return source;
}

void Task::go_on() {
  const config::Config& config = plan_.config;
  const EarlierBuild source = find_source();
  const mesh_io::MeshDescription mesh = description_of(source);
  const BuildPlan plan =
      plan_build(config, mesh, {}, plan_textures(source.materials, config.missing_images, files()));
  check_pictures(source.input, files());
  check_coders(plan.job);
  if (plan.tree.partition_count() != source.decides_result.value("partitions", std::uint64_t{0})) {
    throw Error(ErrorCode::input,
                "pictures of the mesh were changed since the stage read: plan the build again");
  }
  const StageContext context{config, plan, files(), meter_, environment_.cancel};
  open_workshop(plan, {source.decides_result, source.input_times}, mesh.attributes, context);
  if (is_slice() && has_slices_)
    slices_ = std::make_unique<InputSlices>(config, source, Share{index_, plan_.tasks}, *workshop_,
                                            context);
  mount_inputs();
  make(context);
  seal();
}

bool Task::needs(const TaskStage& before, bool is_next) const {
  switch (stage_.kind->takes) {
    case Takes::nothing:
      return false;
    case Takes::input:
      return before.kind->takes == Takes::nothing;
    case Takes::slices:
    case Takes::chunks:
      return true;
    case Takes::level:
      return before.kind->takes == Takes::nothing || is_next;
    case Takes::tiles:
    case Takes::pictures:
      break;
  }
  return before.kind->takes != Takes::slices || before.kind->cut != TaskCut::shares;
}

void Task::mount(const TaskStage& stage) {
  for (std::uint32_t i = 0; i < stage.tasks; ++i) {
    environment_.cancel.check();
    const auto segment = open_segment(files(), work_, name(stage.name, i));
    if (segment->data_bytes() > 0)  // or there is nothing to be read, and no file to be kept open
      (*workshop_.*stage.kind->scratch).mount(segment->take_file());
    segment->for_each([&](const storage::EntrySink::Entry& entry) { return take(entry, i); });
  }
}

bool Task::take(const storage::EntrySink::Entry& entry, std::uint32_t index) {
  if (InputSlices::is_entry(entry)) {
    if (InputSlices::ends_faces(entry))
      last_faces_ = std::min(last_faces_, index);
    return !slices_ || slices_->take(entry, {index, plan_.tasks});
  }
  if (!entry.contains("partition"))
    return workshop_->journal.take_sealed(entry);
  if (!needs_chunk(entry.at("partition")))
    return true;
  return index > last_faces_  // known when `faces` itself is read
             ? workshop_->journal.take_sealed_copies(entry)
             : workshop_->journal.take_sealed(entry);
}

bool Task::needs_chunk(const storage::EntrySink::Entry& partition) const {
  if (!partition.is_array() || partition.empty() || !partition[0].is_number_unsigned())
    return true;  // the journal refuses it
  const Share share{index_, plan_.tasks};
  const std::uint32_t chunks = workshop_->chunks.count();
  const auto chunk = partition[0].get<std::uint64_t>();
  return stage_.kind->takes == Takes::chunks && share.begin(chunks) <= chunk &&
         chunk < share.end(chunks);
}

void Task::mount_inputs() {
  const std::vector<TaskStage> all = stages_of(plan_);
  for (auto before = all.begin(); before->name != stage_.name; ++before) {
    if (needs(*before, std::next(before)->name == stage_.name))
      mount(*before);
  }
}

int Task::cut_levels() const {
  const Tree& tree = workshop_->forest.tree();
  int count = 0;
  while (count < static_cast<int>(plan_.levels) && count < raw(tree.depth()) &&
         tree.node_count(static_cast<Level>(raw(tree.depth()) - count - 1)) >= plan_.tasks) {
    ++count;
  }
  return count;
}

LevelRange Task::part() const {
  const int depth = raw(workshop_->forest.tree().depth());
  const Share share{index_, stage_.tasks};
  const int cut = cut_levels();
  const int up = static_cast<int>(stage_.levels_up);
  switch (stage_.kind->cut) {
    case TaskCut::top:
      return {0, depth - cut, share};
    case TaskCut::levels:
      return up > cut ? LevelRange{depth, depth, share}
                      : LevelRange{depth - up, depth - up + 1, share};
    case TaskCut::whole:
    case TaskCut::shares:
      break;
  }
  return {0, depth + 1, share};
}

void Task::make(const StageContext& context) {
  const TaskKind& kind = *stage_.kind;
  if (kind.slice != nullptr) {
    if (slices_)  // else `read` has made all chunks
      (*slices_.*kind.slice)(*entries_);
    return;
  }
  if (kind.name == kFinishTask)
    return finish_hierarchy(kind, *workshop_, work_, plan_.tasks, *entries_, context);
  const LevelRange part = this->part();
  const bool has_levels = part.top < part.end;
  if (kind.cut == TaskCut::levels && !has_levels)
    return;
  if (kind.takes == Takes::pictures && has_levels && context.plan.textures.is_textured() &&
      (!workshop_->journal.restore_pictures() ||
       workshop_->pictures.size() != context.plan.textures.heads.size()))
    throw damaged_segment(work_, name(kImagesTask, 0));
  Making making{*workshop_, {storage::built_path(work_), attempt_.shared_directory()}};
  make_stages(kind, making, part, context);
}

void Task::seal() {
  meter_.end();
  entries_->append(took_entry(meter_.total()));
  const std::filesystem::path data = (*workshop_.*stage_.kind->scratch).path();
  attempt_.seal(*entries_, files().exists(data) ? data : std::filesystem::path(),
                name(stage_.name, index_), environment_.cancel);
}

/// Finishes the hierarchy: one process at a time, from the first file to the name.
TaskReport finish(const TaskPlan& plan, const TaskStage& stage, const TaskRequest& request,
                  const BuildEnvironment& environment) {
  TaskReport report;
  if (request.worker.index != 0)
    return report;
  storage::FileSystem& files = environment.files;
  storage::WorkDirectory shared(files, {plan.config.output, plan.config.storage.container},
                                plan.replace, request.work);
  if (storage::Segment::is_whole(files, request.work, {plan.fingerprint, stage.name, 0})) {
    ++report.found;
  } else {
    Task(plan, stage, 0, request, environment).run();
    ++report.done;
  }
  report.text = name_hierarchy(plan, shared, files);
  return report;
}

}  // namespace

TaskReport run_tasks(const TaskRequest& request, const BuildEnvironment& environment) {
  storage::FileSystem& files = environment.files;
  TaskPlan plan = read_task_plan(files, request.work, request.program);
  if (request.threads > 0)
    plan.config.threads = request.threads;
  if (request.memory_budget > 0)
    plan.config.memory_budget = request.memory_budget;
  const TaskStage stage = find_stage(plan, request.stage);
  execution::configure_allocator(memory_budget(plan.config));
  const tbb::global_control thread_limit(tbb::global_control::max_allowed_parallelism,
                                         thread_count(plan.config));
  if (stage.kind->name == kFinishTask)
    return finish(plan, stage, request, environment);
  TaskReport report;
  const bool is_finished = is_named(plan, request.work, files);  // the segments are gone then
  for (std::uint64_t i = request.worker.index; i < stage.tasks; i += request.worker.of) {
    const auto index = static_cast<std::uint32_t>(i);
    if (is_finished ||
        storage::Segment::is_whole(files, request.work, {plan.fingerprint, stage.name, index})) {
      ++report.found;
      continue;
    }
    Task(plan, stage, index, request, environment).run();
    execution::release_free_memory();
    ++report.done;
  }
  return report;
}

}  // namespace meshhier::pipeline
