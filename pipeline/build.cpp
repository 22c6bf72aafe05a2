#include "pipeline/build.h"

#include "base/error.h"
#include "execution/allocator.h"
#include "execution/memory_budget.h"
#include "pipeline/import_stage.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/pack_stage.h"
#include "pipeline/plan/disk_claims.h"
#include "pipeline/read_stage.h"
#include "pipeline/stage_costs.h"
#include "pipeline/stages.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"

#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tbb/global_control.h>

namespace meshhier::pipeline {
namespace {

// From the whole to its parts: the definitions follow in this order.

/// Does in the locked directory what is left to do once the build can begin: imports the mesh if it
/// was not planned yet, then does the other stages.
BuildReport build_in(storage::WorkDirectory& work, importing::MeshInput& input,
                     std::optional<BuildPlan> plan, storage::MemoryPool& pool,
                     const config::Config& config, const BuildOptions& options,
                     const BuildEnvironment& environment);

/// Does all stages but import, then gives the hierarchy its name.
BuildReport run_stages(importing::MeshInput& input, storage::WorkDirectory& work,
                       storage::MemoryPool& pool, StageMeter& meter, Restart restart,
                       const StageContext& context);

/// Makes all files of the hierarchy in `directory`: does all rows of the table (stages.cpp) between
/// reading the input and packing the output, as far as the journal does not have their work.
/// Returns how much disk they need, as it is known after leaves and simplify, and throws
/// Error(budget) then if there is less.
DiskNeed make_hierarchy(Workshop& workshop, const std::filesystem::path& directory,
                        const StageContext& context);

/// Returns the failure with a sentence that says where the work lies that can be gone on with.
Error with_resume_hint(const Error& error, const storage::WorkDirectory& work,
                       const std::filesystem::path& output);

/// Throws Error(budget) if there is less disk than is needed, as far as that is known.
void check_room(const importing::MeshInput& input, const std::optional<BuildPlan>& plan,
                const config::Config& config, storage::FileSystem& files);

/// Claims the disk that is needed, and throws as check_room().
void claim_room(const storage::WorkDirectory& work, const importing::MeshInput& input,
                const std::optional<BuildPlan>& plan, const config::Config& config,
                storage::FileSystem& files, storage::ScratchUse& use);

/// Removes the imported mesh while the work directory is still locked.
struct DropAtEnd {
  importing::MeshInput& input;
  ~DropAtEnd() { input.drop(); }
};

}  // namespace

BuildReport build_hierarchy(const config::Config& config, const BuildOptions& options,
                            const BuildEnvironment& environment) {
  return build_if_due(config, options, environment).value();
}

std::optional<BuildReport> build_if_due(const config::Config& asked, const BuildOptions& options,
                                        BuildEnvironment environment) {
  storage::FileSystem& files = environment.files;
  config::Config config = asked;
  config.output = storage::followed(files, asked.output);
  execution::configure_allocator(memory_budget(config));
  if (const auto warning = execution::budget_warning("memory_budget", memory_budget(config));
      !warning.empty())
    environment.progress.warn(warning);

  // Everything that can be refused is refused before anything is written.
  check_apart(config, files);
  storage::MemoryPool pool(0);
  importing::MeshInput input = open_input(config, files);
  std::optional<BuildPlan> plan;
  if (!is_read_before_plan(input, config))
    plan = plan_build(config, input.description());
  const tbb::global_control thread_limit(tbb::global_control::max_allowed_parallelism,
                                         thread_count(config));
  const storage::Output output(config.output, config.storage.container);
  storage::check_output(files, output, options.force);
  storage::check_place(files, config.output);
  if (plan)
    check_coders(plan->job);
  check_room(input, plan, config, files);

  storage::WorkDirectory work(files, output, options.force, [&] { environment.cancel.check(); });
  if (!options.is_due())
    return std::nullopt;
  return build_in(work, input, std::move(plan), pool, config, options, environment);
}

namespace {

BuildReport build_in(storage::WorkDirectory& work, importing::MeshInput& input,
                     std::optional<BuildPlan> plan, storage::MemoryPool& pool,
                     const config::Config& config, const BuildOptions& options,
                     const BuildEnvironment& environment) {
  storage::FileSystem& files = environment.files;
  if (options.restart == Restart::always)
    work.clear();
  claim_room(work, input, plan, config, files, pool.scratch_use());
  const DropAtEnd drop{input};
  StageMeter meter({environment.progress, files.counters(), pool.scratch_use()});
  if (!plan)
    plan = import_and_plan(input, work, pool, config, {files, meter, environment.cancel});
  check_apart(input.files().companions(), config, options.others, files);
  try {
    BuildReport report = run_stages(input, work, pool, meter, options.restart,
                                    {config, *plan, files, meter, environment.cancel});
    options.on_made(report);
    return report;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::input || !options.leaves_work)
      work.keep(false);  // nothing to go on with
    if (!work.is_kept() || error.code() == ErrorCode::exists ||
        error.code() == ErrorCode::other_work)
      throw;
    throw with_resume_hint(error, work, config.output);
  }
}

/// Bytes that went to files which are not temporary.
std::uint64_t written_for_good(storage::FileSystem& files, const storage::ScratchUse& use) {
  return files.counters().bytes_written - use.bytes_written();
}

BuildReport run_stages(importing::MeshInput& input, storage::WorkDirectory& work,
                       storage::MemoryPool& pool, StageMeter& meter, Restart restart,
                       const StageContext& context) {
  storage::FileSystem& files = context.files;
  storage::ScratchUse& use = pool.scratch_use();
  pool.set_capacity(context.memory().pool_bytes);
  meter.expect(wall_times(context.plan));
  if (files.exists(storage::journal_path(work.path())))
    meter.stage("resume", 0, "entries");
  const OpenWorkshop open = open_workshop(work, input, pool, restart, context);
  Workshop& workshop = *open.workshop;
  if (!workshop.journal.source()) {
    if (!can_be_read(input, context.config))
      import_again(input, work, pool, context);
    read_mesh(input, workshop, context);
  }
  input.drop();
  work.keep(true);  // the journal has the input

  const std::uint64_t before = written_for_good(files, use);
  DiskNeed predicted = context.plan.disk;
  if (!workshop.journal.is_complete())
    predicted = make_hierarchy(workshop, work.built(), context);
  const storage::HierarchyReader made(files, work.built());
  BuildOutcome outcome{.found = open.found,
                       .output_bytes = bytes_of(made, files),
                       .has_area = has_area(made, context.cancel),
                       .predicted = predicted,
                       .input = workshop.journal.source()->input,
                       .copies_between_tiles = input.copies_between_tiles()};
  context.cancel.check();
  if (context.config.storage.container == storage::Container::archive) {
    use.add_written(written_for_good(files, use) - before);
    const TemporaryFiles unpacked(use, outcome.output_bytes);
    workshop.tile_scratch.remove();  // the archive needs its room
    outcome.output_bytes = pack(made, work.packed(), use, context);
  }
  meter.stage("sync", 0, "bytes");
  context.cancel.check();
  workshop.tile_scratch.remove();  // the sync would take it along
  work.publish();
  meter.end();
  outcome.peak_temporary_bytes = use.peak_bytes_on_disk();
  return make_report(made, outcome, meter, context);
}

DiskNeed make_hierarchy(Workshop& workshop, const std::filesystem::path& directory,
                        const StageContext& context) {
  Making making{workshop, {directory}, context.plan.disk};
  const LevelRange all{0, raw(context.tree().depth()) + 1};
  for (const Stage* stage : stages_of(context.plan.job)) {
    if (stage->make == nullptr)
      continue;
    stage->make(making, all, context);
    if (stage->then != nullptr)
      stage->then(making, context);
  }
  workshop.journal.note_complete();
  return making.disk;
}

Error with_resume_hint(const Error& error, const storage::WorkDirectory& work,
                       const std::filesystem::path& output) {
  return {error.code(),
          fmt::format("{}\nWhat is done so far is kept in {}: the same build goes on with it "
                      "(--restart begins anew, \"meshhier clean --remove {}\" removes it)",
                      error.what(), work.path().string(), output.string())};
}

void check_room(const importing::MeshInput& input, const std::optional<BuildPlan>& plan,
                const config::Config& config, storage::FileSystem& files) {
  if (plan)
    check_disk(plan->disk, config.output, files);
  else
    check_import_disk(import_disk(input, config), config.output, files);
}

void claim_room(const storage::WorkDirectory& work, const importing::MeshInput& input,
                const std::optional<BuildPlan>& plan, const config::Config& config,
                storage::FileSystem& files, storage::ScratchUse& use) {
  const std::uint64_t bytes = plan ? plan->disk.room_bytes : import_disk(input, config);
  claim_disk(work.path(), bytes, files, use, [&] { check_room(input, plan, config, files); });
}

}  // namespace
}  // namespace meshhier::pipeline
