#include "pipeline/build.h"

#include "partition/top_tree.h"
#include "pipeline/build_plan.h"
#include "pipeline/forest.h"
#include "pipeline/memory_plan.h"
#include "pipeline/outline_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/publish_stage.h"
#include "pipeline/simplify_stage.h"
#include "pipeline/size_text.h"
#include "pipeline/source_mesh.h"
#include "storage/layout.h"
#include "storage/work_directory.h"

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

BuildStats make_stats(const Config& config, const SourceSummary& source,
                      const PublishedSummary& published, const BuildPlan& plan) {
  BuildStats stats;
  stats.config = whole_config(config);
  stats.threads = plan.threads;
  stats.memory_budget_bytes = config.memory_budget;
  stats.vertices = source.vertices;
  stats.triangles = source.triangles;
  stats.partitions = plan.tree.partition_count();
  stats.levels = raw(plan.tree.depth()) + 1;
  stats.tiles = published.tiles;
  stats.input_bytes = source.file_bytes;
  stats.output_bytes = published.total_bytes;
  stats.predicted_output_bytes = plan.disk.output_bytes;
  stats.predicted_temporary_bytes = plan.disk.temporary_bytes;
  return stats;
}

std::string report_text(const SourceSummary& source, const BuildStats& stats) {
  std::string text =
      fmt::format("{} vertices, {} triangles -> {} partitions, {} levels, {} tiles, {}\n",
                  source.vertices, source.triangles, stats.partitions, stats.levels, stats.tiles,
                  rounded_size_text(stats.output_bytes));
  if (source.degenerate_triangles > 0) {
    text += fmt::format("dropped {} degenerate triangles\n", source.degenerate_triangles);
  }
  if (source.unreferenced_vertices > 0) {
    text += fmt::format("kept {} vertices that no triangle uses\n", source.unreferenced_vertices);
  }
  return text + stats_text(stats);
}

}  // namespace

BuildReport build_hierarchy(const Config& config, bool force, BuildEnvironment environment) {
  storage::FileSystem& files = environment.files;
  const CancelToken& cancel = environment.cancel;
  configure_allocator(config.memory_budget);

  // Everything that can be refused is refused before anything is written.
  check_apart(config, files);
  std::unique_ptr<mesh_io::MeshSource> source = mesh_io::open_mesh(files, config.input);
  const BuildPlan build = plan_build(config, source->description());
  const Tree& tree = build.tree;
  const MemoryPlan& plan = build.memory;
  const tbb::global_control thread_limit(tbb::global_control::max_allowed_parallelism,
                                         build.threads);
  storage::MemoryPool pool(plan.pool_bytes);
  StageMeter progress({environment.progress, files.counters(), pool.scratch_use()});
  storage::check_output(files, config.output, force);
  check_disk(build.disk, config.output, files);
  storage::WorkDirectory work(files, config.output, force);

  storage::ScratchFile tile_scratch(files, work.temporary() / "tiles", pool);
  Forest forest(tree, partition::chunk_level(tree), build.job.channels, tile_scratch);

  PublishInput result;
  {
    storage::ScratchFile mesh_scratch(files, work.temporary() / "mesh", pool);
    SourceMesh mesh(std::move(source), config.input.filename().string(), mesh_scratch,
                    plan.blocks_in_flight, progress, cancel);
    Chunks chunks =
        distribute(mesh, tree, config.partition.axis, plan, mesh_scratch, progress, cancel);
    result.source = mesh.summary();
    result.source.checksum = mesh.checksum(cancel);
    result.format = {mesh.summary().attributes, mesh.origin()};
    result.source.unreferenced_vertices =
        make_leaves(chunks, forest, config.partition.axis, plan, progress, cancel);
  }
  const double diagonal = length(result.source.bounds.max - result.source.bounds.min);
  result.asked_vertices = build.asked_vertices;
  result.config = resolved_json(config);
  simplify(forest,
           {result.asked_vertices,
            result.source.attributes,
            {config.simplify.method, config.simplify.representative, config.simplify.cost},
            diagonal},
           plan, progress, cancel);
  result.outline = make_outline(forest, config.outline, diagonal, plan, progress, cancel);
  const PublishedSummary published =
      publish(forest, result, work.path(), plan, files, progress, cancel);
  const std::uint64_t manifest_bytes = files.open(storage::manifest_path(work.path()))->size();
  cancel.check();
  progress.begin("sync");
  work.publish();
  progress.end();

  BuildReport report;
  report.stats = make_stats(config, result.source, published, build);
  report.stats.output_bytes += manifest_bytes;
  report.stats.peak_temporary_bytes = pool.scratch_use().peak_bytes_on_disk();
  report.stats.stages = progress.stages();
  report.stats.total = progress.total();
  report.text = report_text(result.source, report.stats);
  return report;
}

}  // namespace meshhier::pipeline
