#include "pipeline/build.h"

#include "config/config_schema.h"
#include "execution/allocator.h"
#include "execution/size_text.h"
#include "hierarchy/error.h"
#include "hierarchy/plain_text.h"
#include "import/import_input.h"
#include "import/mesh_input.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/outline_stage.h"
#include "pipeline/pack_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/plan/build_plan.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/publish_stage.h"
#include "pipeline/simplify_stage.h"
#include "pipeline/source_mesh.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/format/tileset.h"
#include "storage/format/work_directory.h"

#include <algorithm>
#include <future>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tbb/global_control.h>

namespace meshhier::pipeline {
namespace {

constexpr std::size_t kLongestName = 255;

/// What `config` became, with what does not decide the result.
nlohmann::ordered_json whole_config(const config::Config& config) {
  nlohmann::ordered_json whole{{"input", config::find_config_key("input")->show(config)},
                               {"output", config.output.string()},
                               {"memory_budget", execution::exact_size_text(config.memory_budget)},
                               {"threads", config.threads}};
  whole.update(config::resolved_json(config));
  whole["storage"]["container"] = config::find_config_key("storage.container")->show(config);
  return whole;
}

BuildStats make_stats(const config::Config& config, const storage::HierarchyReader& made,
                      const BuildPlan& plan) {
  const SourceSummary& source = made.manifest().source;
  BuildStats stats;
  stats.config = whole_config(config);
  stats.threads = plan.threads;
  stats.memory_budget_bytes = config.memory_budget;
  stats.vertices = source.vertices;
  stats.triangles = source.triangles;
  stats.partitions = plan.tree.partition_count();
  stats.levels = raw(plan.tree.depth()) + 1;
  stats.tiles = made.records().size();
  stats.input_bytes = source.file_bytes;
  stats.predicted_output_bytes = plan.disk.output_bytes;
  stats.predicted_temporary_bytes = plan.disk.temporary_bytes;
  return stats;
}

std::string report_text(const SourceSummary& source, const std::string& found,
                        const BuildStats& stats) {
  std::string text = found.empty() ? "" : found + '\n';
  text += fmt::format("{} vertices, {} triangles -> {} partitions, {} levels, {} tiles, {}\n",
                      source.vertices, source.triangles, stats.partitions, stats.levels,
                      stats.tiles, execution::rounded_size_text(stats.output_bytes));
  for (const SourceFile& file : source.files) {
    text += fmt::format("imported {}: {}, {}\n", plain_text(file.name, kLongestName), file.format,
                        execution::rounded_size_text(file.bytes));
  }
  if (!source.counts.empty())
    text += "counted " + importing::counts_text(source.counts) + '\n';
  if (source.degenerate_triangles > 0) {
    text += fmt::format("dropped {} degenerate triangles\n", source.degenerate_triangles);
  }
  if (source.unreferenced_vertices > 0) {
    text += fmt::format("kept {} vertices that no triangle uses\n", source.unreferenced_vertices);
  }
  return text + stats_text(stats);
}

importing::MeshInput::Place import_place(const storage::WorkDirectory& work,
                                         storage::MemoryPool& pool, std::uint64_t sort_bytes,
                                         execution::Progress& progress,
                                         const execution::CancelToken& cancel) {
  return {storage::imported_path(work.path()),
          work.path() / "import",
          pool,
          sort_bytes,
          progress,
          cancel};
}

/// Checks, samples and distributes the input, and notes what was learnt of it.
void read_input(importing::MeshInput& input, const config::Config& config, const BuildPlan& build,
                Workshop& workshop, execution::Progress& progress, BuildEnvironment environment) {
  const execution::CancelToken& cancel = environment.cancel;
  storage::ScratchFile vertices = workshop.mesh_scratch.beside("vertices");
  SourceMesh mesh(input.open(), input.files().name(), vertices, build.memory.blocks_in_flight,
                  progress, cancel);
  distribute(mesh, build.tree, config.partition.axis, workshop.chunks, build.memory,
             workshop.mesh_scratch, progress, cancel);
  SourceSummary summary = mesh.summary();
  if (input.needs_import()) {
    input.complete(summary);
  } else {
    summary.checksum = mesh.checksum(cancel);
    input.files().check_unchanged();
  }
  workshop.journal.note_source(summary, mesh.origin());
}

std::optional<Transform> tileset_transform(const config::Config& config) {
  const config::PlacementConfig& place = config.placement;
  if (!place.longitude)
    return place.transform;
  const auto [x, y, z] = place.anchor.value_or(std::array<double, 3>{});
  return storage::globe_transform(*place.longitude, *place.latitude, place.height.value_or(0),
                                  {x, y, z}, config.up);
}

/// What was recalled of an earlier build is of no use after all: the input is imported again.
void import_again(importing::MeshInput& input, const importing::MeshInput::Place& place) {
  const mesh_io::MeshDescription recalled = input.description();
  input.import(place);
  const mesh_io::MeshDescription& mesh = input.description();
  if (mesh.vertex_count != recalled.vertex_count || mesh.face_count != recalled.face_count ||
      mesh.attributes != recalled.attributes) {
    throw Error(ErrorCode::input, input.files().name() + " was changed; build it again");
  }
}

/// A failure that leaves work to go on with says so.
Error with_resume_hint(const Error& error, const storage::WorkDirectory& work) {
  return {error.code(),
          fmt::format("{}\nWhat is done so far is kept in {}: the same build goes on with it "
                      "(--restart begins anew, \"meshhier clean\" removes it)",
                      error.what(), work.path().string())};
}

/// Makes all files of the hierarchy in `directory`, as far as the journal does not have them.
void make_hierarchy(const config::Config& config, const BuildPlan& build, Workshop& workshop,
                    const std::filesystem::path& directory, execution::Progress& progress,
                    BuildEnvironment environment) {
  const execution::CancelToken& cancel = environment.cancel;
  const MemoryPlan& plan = build.memory;
  auto& [mesh_scratch, tile_scratch, chunks, forest, journal] = workshop;
  PublishInput result;
  result.source = journal.source()->summary;
  result.format = {result.source.attributes,
                   {journal.source()->origin, config.up},
                   config.storage.compression,
                   {}};
  result.position_bits = config.storage.position_bits;
  result.transform = tileset_transform(config);
  result.licence = config.licence;
  result.is_temporary = config.storage.container == storage::Container::archive;
  result.source.unreferenced_vertices =
      make_leaves(chunks, forest, journal, config.partition.axis, plan, progress, cancel);
  // Without the chunks leaves cannot be made again, so these reach the disk before those go.
  std::future<void> settled = std::async(std::launch::async, [&workshop, &cancel] {
    workshop.tile_scratch.sync([&] { cancel.check(); });
    workshop.journal.sync();
    workshop.mesh_scratch.remove();
  });

  const double diagonal = length(result.source.bounds.max - result.source.bounds.min);
  result.target_vertex_counts = build.target_vertex_counts;
  result.config = config::resolved_json(config);
  simplify(forest, journal,
           {result.target_vertex_counts,
            result.source.attributes,
            {config.simplify.method, config.simplify.representative, config.simplify.cost},
            diagonal},
           plan, progress, cancel);
  settled.get();
  result.outline = make_outline(forest, config.outline, diagonal, plan, progress, cancel);
  publish(forest, journal, result, directory, plan, environment.files, progress, cancel);
  journal.note_complete();
}

/// Bytes that went to files which are not temporary.
std::uint64_t written_for_good(storage::FileSystem& files, const storage::ScratchUse& use) {
  return files.counters().bytes_written - use.bytes_written();
}

BuildReport build_in(storage::WorkDirectory& work, const config::Config& config,
                     const BuildPlan& build, importing::MeshInput& input, storage::MemoryPool& pool,
                     StageMeter& progress, BuildEnvironment environment) {
  storage::FileSystem& files = environment.files;
  pool.set_capacity(build.memory.pool_bytes);
  if (files.exists(storage::journal_path(work.path())))
    progress.stage("resume", 0, "entries");
  const OpenWorkshop open =
      open_workshop(files, work, config, input, build, pool, environment.cancel);
  Workshop& workshop = *open.workshop;
  if (!workshop.journal.source()) {
    if (!input.can_be_read()) {
      const std::uint64_t sort_bytes = std::min(
          importing::plan_import(config.memory_budget).sort_bytes, build.memory.work_bytes / 4);
      import_again(input, import_place(work, pool, sort_bytes, progress, environment.cancel));
    }
    read_input(input, config, build, workshop, progress, environment);
  }
  input.drop();
  work.keep(true);
  const std::uint64_t before = written_for_good(files, pool.scratch_use());
  if (!workshop.journal.is_complete())
    make_hierarchy(config, build, workshop, work.built(), progress, environment);
  const storage::HierarchyReader made(files, work.built());
  std::uint64_t output_bytes =
      made.manifest().total_bytes + files.open(storage::manifest_path(work.built()))->size();
  environment.cancel.check();
  if (config.storage.container == storage::Container::archive) {
    storage::ScratchUse& use = pool.scratch_use();
    use.add_written(written_for_good(files, use) - before);
    const TemporaryFiles unpacked(use, output_bytes);
    workshop.tile_scratch.remove();  // the archive needs its room
    output_bytes = pack(made, work.packed(), files, use, progress, environment.cancel);
  }
  progress.begin("sync");
  workshop.tile_scratch.remove();  // the sync would take it along
  work.publish();
  progress.end();

  BuildReport report;
  report.stats = make_stats(config, made, build);
  report.stats.output_bytes = output_bytes;
  report.stats.peak_temporary_bytes = pool.scratch_use().peak_bytes_on_disk();
  report.stats.stages = progress.stages();
  report.stats.total = progress.total();
  report.text = report_text(made.manifest().source, open.found, report.stats);
  return report;
}

/// What was imported goes while the work directory is locked.
struct DropAtEnd {
  importing::MeshInput& input;
  ~DropAtEnd() { input.drop(); }
};

/// Imports the input, unless an earlier build did; then it is known what there is to do.
BuildPlan plan_imported(storage::WorkDirectory& work, const config::Config& config,
                        importing::MeshInput& input, storage::MemoryPool& pool,
                        StageMeter& progress, BuildEnvironment environment) {
  const auto earlier = find_earlier_build(environment.files, work.path());
  work.keep(earlier.has_value());
  const auto recalled = earlier ? recall_import(*earlier, input, environment.cancel) : std::nullopt;
  if (recalled) {
    input.recall(*recalled);
  } else {
    const importing::ImportMemory memory = importing::plan_import(config.memory_budget);
    pool.set_capacity(memory.pool_bytes);
    input.import(import_place(work, pool, memory.sort_bytes, progress, environment.cancel));
    execution::release_free_memory();
  }
  BuildPlan build = plan_build(config, input.description(), input.imported_bytes());
  build.disk.temporary_bytes = std::max(
      build.disk.temporary_bytes,
      importing::predict_import(input.files(), importing::plan_import(config.memory_budget)));
  check_disk(build.disk, config.output, environment.files);
  return build;
}

}  // namespace

BuildReport build_hierarchy(const config::Config& config, const BuildOptions& options,
                            BuildEnvironment environment) {
  storage::FileSystem& files = environment.files;
  execution::configure_allocator(config.memory_budget);

  // Everything that can be refused is refused before anything is written.
  check_apart(config, files);
  storage::MemoryPool pool(0);
  importing::MeshInput input(config.input, config.weld, files);
  std::optional<BuildPlan> build;
  if (!input.needs_import())
    build = plan_build(config, input.description());
  const tbb::global_control thread_limit(tbb::global_control::max_allowed_parallelism,
                                         thread_count(config));
  const storage::Output output(config.output, config.storage.container);
  storage::check_output(files, output, options.force);
  if (build)
    check_disk(build->disk, config.output, files);
  else
    check_import_disk(
        importing::predict_import(input.files(), importing::plan_import(config.memory_budget)),
        config.output, files);

  storage::WorkDirectory work(files, output, options.force);
  if (options.restart)
    work.clear();
  const DropAtEnd drop{input};
  StageMeter progress({environment.progress, files.counters(), pool.scratch_use()});
  if (!build)
    build = plan_imported(work, config, input, pool, progress, environment);
  try {
    return build_in(work, config, *build, input, pool, progress, environment);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::input)
      work.keep(false);  // nothing to go on with
    if (!work.is_kept() || error.code() == ErrorCode::exists)
      throw;
    throw with_resume_hint(error, work);
  }
}

}  // namespace meshhier::pipeline
