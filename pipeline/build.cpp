#include "pipeline/build.h"

#include "pipeline/build_plan.h"
#include "pipeline/memory_plan.h"
#include "pipeline/outline_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/publish_stage.h"
#include "pipeline/simplify_stage.h"
#include "pipeline/size_text.h"
#include "pipeline/source_mesh.h"
#include "pipeline/workshop.h"
#include "storage/hierarchy_reader.h"
#include "storage/layout.h"
#include "storage/tileset.h"
#include "storage/work_directory.h"

#include <future>
#include <utility>

#include <fmt/format.h>
#include <tbb/global_control.h>

namespace meshhier::pipeline {
namespace {

/// What `config` became, with what does not decide the result.
nlohmann::ordered_json whole_config(const Config& config) {
  nlohmann::ordered_json whole{{"input", config.input.string()},
                               {"output", config.output.string()},
                               {"memory_budget", exact_size_text(config.memory_budget)},
                               {"threads", config.threads}};
  whole.update(resolved_json(config));
  return whole;
}

BuildStats make_stats(const Config& config, const storage::HierarchyReader& made,
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
  stats.output_bytes = made.manifest().total_bytes;
  stats.predicted_output_bytes = plan.disk.output_bytes;
  stats.predicted_temporary_bytes = plan.disk.temporary_bytes;
  return stats;
}

std::string report_text(const SourceSummary& source, const std::string& found,
                        const BuildStats& stats) {
  std::string text = found.empty() ? "" : found + '\n';
  text += fmt::format("{} vertices, {} triangles -> {} partitions, {} levels, {} tiles, {}\n",
                      source.vertices, source.triangles, stats.partitions, stats.levels,
                      stats.tiles, rounded_size_text(stats.output_bytes));
  if (source.degenerate_triangles > 0) {
    text += fmt::format("dropped {} degenerate triangles\n", source.degenerate_triangles);
  }
  if (source.unreferenced_vertices > 0) {
    text += fmt::format("kept {} vertices that no triangle uses\n", source.unreferenced_vertices);
  }
  return text + stats_text(stats);
}

/// Checks, samples and distributes the input, and notes what was learnt of it.
void read_input(std::unique_ptr<mesh_io::MeshSource> source, const Config& config,
                const BuildPlan& build, Workshop& workshop, Progress& progress,
                BuildEnvironment environment) {
  const CancelToken& cancel = environment.cancel;
  const storage::FileIdentity before = environment.files.identity(config.input);
  storage::ScratchFile vertices = workshop.mesh_scratch.beside("vertices");
  SourceMesh mesh(std::move(source), config.input.filename().string(), vertices,
                  build.memory.blocks_in_flight, progress, cancel);
  distribute(mesh, build.tree, config.partition.axis, workshop.chunks, build.memory,
             workshop.mesh_scratch, progress, cancel);
  SourceSummary summary = mesh.summary();
  summary.checksum = mesh.checksum(cancel);
  if (environment.files.identity(config.input) != before) {
    throw Error(ErrorCode::input,
                config.input.string() + " was changed while it was read; build it again");
  }
  workshop.journal.note_source(summary, mesh.origin());
}

std::optional<Transform> tileset_transform(const Config& config) {
  const PlacementConfig& place = config.placement;
  if (!place.longitude)
    return place.transform;
  const auto [x, y, z] = place.anchor.value_or(std::array<double, 3>{});
  return storage::globe_transform(*place.longitude, *place.latitude, place.height.value_or(0),
                                  {x, y, z}, config.up);
}

/// A failure that leaves work to go on with says so.
Error told_how_to_go_on(const Error& error, const storage::WorkDirectory& work) {
  return {error.code(),
          fmt::format("{}\nWhat is done so far is kept in {}: the same build goes on with it "
                      "(--restart begins anew, \"meshhier clean\" removes it)",
                      error.what(), work.path().string())};
}

/// Makes all files of the hierarchy in `directory`, as far as the journal does not have them.
void make_hierarchy(const Config& config, const BuildPlan& build, Workshop& workshop,
                    const std::filesystem::path& directory, Progress& progress,
                    BuildEnvironment environment) {
  const CancelToken& cancel = environment.cancel;
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
  result.source.unreferenced_vertices =
      make_leaves(chunks, forest, journal, config.partition.axis, plan, progress, cancel);
  // Without the chunks leaves cannot be made again, so these reach the disk before those go.
  std::future<void> settled = std::async(std::launch::async, [&workshop, &cancel] {
    workshop.tile_scratch.sync([&] { cancel.check(); });
    workshop.journal.sync();
    workshop.mesh_scratch.remove();
  });

  const double diagonal = length(result.source.bounds.max - result.source.bounds.min);
  result.asked_vertices = build.asked_vertices;
  result.config = resolved_json(config);
  simplify(forest, journal,
           {result.asked_vertices,
            result.source.attributes,
            {config.simplify.method, config.simplify.representative, config.simplify.cost},
            diagonal},
           plan, progress, cancel);
  settled.get();
  result.outline = make_outline(forest, config.outline, diagonal, plan, progress, cancel);
  publish(forest, journal, result, directory, plan, environment.files, progress, cancel);
  journal.note_complete();
}

BuildReport build_in(storage::WorkDirectory& work, const Config& config, const BuildPlan& build,
                     std::unique_ptr<mesh_io::MeshSource> source, BuildEnvironment environment) {
  storage::FileSystem& files = environment.files;
  storage::MemoryPool pool(build.memory.pool_bytes);
  StageMeter progress({environment.progress, files.counters(), pool.scratch_use()});

  if (files.exists(storage::journal_path(work.path())))
    progress.stage("resume", 0, "entries");
  const OpenWorkshop open =
      open_workshop(files, work, config, *source, build, pool, environment.cancel);
  Workshop& workshop = *open.workshop;
  if (!workshop.journal.source())
    read_input(std::move(source), config, build, workshop, progress, environment);
  work.keep(true);
  if (!workshop.journal.is_complete())
    make_hierarchy(config, build, workshop, work.built(), progress, environment);
  const storage::HierarchyReader made(files, work.built());
  const std::uint64_t manifest_bytes = files.open(storage::manifest_path(work.built()))->size();
  environment.cancel.check();
  progress.begin("sync");
  workshop.tile_scratch.remove();  // the sync would take it along
  work.publish();
  progress.end();

  BuildReport report;
  report.stats = make_stats(config, made, build);
  report.stats.output_bytes += manifest_bytes;
  report.stats.peak_temporary_bytes = pool.scratch_use().peak_bytes_on_disk();
  report.stats.stages = progress.stages();
  report.stats.total = progress.total();
  report.text = report_text(made.manifest().source, open.found, report.stats);
  return report;
}

}  // namespace

BuildReport build_hierarchy(const Config& config, const BuildOptions& options,
                            BuildEnvironment environment) {
  storage::FileSystem& files = environment.files;
  configure_allocator(config.memory_budget);

  // Everything that can be refused is refused before anything is written.
  check_apart(config, files);
  std::unique_ptr<mesh_io::MeshSource> source = mesh_io::open_mesh(files, config.input);
  const BuildPlan build = plan_build(config, source->description());
  const tbb::global_control thread_limit(tbb::global_control::max_allowed_parallelism,
                                         build.threads);
  storage::check_output(files, config.output, options.force);
  check_disk(build.disk, config.output, files);

  storage::WorkDirectory work(files, config.output, options.force);
  if (options.restart)
    work.clear();
  try {
    return build_in(work, config, build, std::move(source), environment);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::input)
      work.keep(false);  // nothing to go on with
    if (!work.is_kept() || error.code() == ErrorCode::exists)
      throw;
    throw told_how_to_go_on(error, work);
  }
}

}  // namespace meshhier::pipeline
