#include "pipeline/build.h"

#include "partition/top_tree.h"
#include "pipeline/forest.h"
#include "pipeline/measure_stage.h"
#include "pipeline/memory_plan.h"
#include "pipeline/outline_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/publish_stage.h"
#include "pipeline/simplify_stage.h"
#include "pipeline/size_text.h"
#include "pipeline/source_mesh.h"
#include "storage/hash.h"
#include "storage/layout.h"
#include "storage/work_directory.h"

#include <algorithm>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

namespace meshhier::pipeline {
namespace {

constexpr std::uint32_t kLargestTile = 32768;  // parent maps and ghost references hold 16 bits

Tree plan_tree(const Config& config, std::uint64_t vertex_count) {
  if (vertex_count == 0) {
    throw Error(ErrorCode::input, fmt::format("{} has no vertices: there is nothing to build",
                                              config.input.string()));
  }
  const std::uint64_t count =
      config.partition.count
          ? *config.partition.count
          : (vertex_count + config.partition.vertices - 1) / config.partition.vertices;
  if (count > vertex_count) {
    throw Error(ErrorCode::usage, fmt::format("partition.count is {}, but {} has only {} vertices",
                                              count, config.input.string(), vertex_count));
  }
  if ((vertex_count + count - 1) / count > kLargestTile) {
    throw Error(ErrorCode::usage,
                fmt::format("partition.count is {}: partitions of {} vertices; a tile holds at "
                            "most {}, so the count "
                            "must be at least {}",
                            count, (vertex_count + count - 1) / count, kLargestTile,
                            (vertex_count + kLargestTile - 1) / kLargestTile));
  }
  return {vertex_count, static_cast<std::uint32_t>(count)};
}

std::uint32_t largest_partition(const Tree& tree) {
  return static_cast<std::uint32_t>((tree.vertex_count() + tree.partition_count() - 1) /
                                    tree.partition_count());
}

std::uint32_t asked_vertices(const Config& config, const Tree& tree) {
  if (config.simplify.vertices)
    return *config.simplify.vertices;
  return config.partition.count ? std::max(4U, largest_partition(tree)) : config.partition.vertices;
}

JobSize job_size(const Config& config, const mesh_io::MeshDescription& mesh, const Tree& tree,
                 std::size_t threads) {
  JobSize job;
  job.vertex_count = mesh.vertex_count;
  job.face_count = mesh.face_count;
  job.channels = mesh.attributes.channels();
  job.vertices_in_place = mesh.vertices_in_place;
  job.partition_count = tree.partition_count();
  job.largest_tile = std::max(largest_partition(tree), asked_vertices(config, tree));
  job.threads = threads;
  job.asked_vertices = asked_vertices(config, tree);
  return job;
}

void check_disk(const DiskNeed& need, const std::filesystem::path& directory,
                storage::FileSystem& files) {
  const std::uint64_t free = files.free_bytes(directory);
  if (free < need.temporary_bytes + need.output_bytes) {
    throw Error(
        ErrorCode::budget,
        fmt::format(
            "{} has {} free; the hierarchy will take about {} and up to {} of temporary files",
            directory.string(), rounded_size_text(free), rounded_size_text(need.output_bytes),
            rounded_size_text(need.temporary_bytes)));
  }
}

/// A replaced output is removed, and the input must not go with it.
void check_apart(const Config& config, storage::FileSystem& files) {
  const std::filesystem::path input = files.canonical(config.input);
  const std::filesystem::path output = files.canonical(config.output);
  const auto [end, rest] = std::mismatch(output.begin(), output.end(), input.begin(), input.end());
  if (end == output.end()) {
    throw Error(ErrorCode::usage,
                fmt::format("the input {} lies in the output {}", input.string(), output.string()));
  }
}

std::uint64_t checksum_of_file(storage::FileSystem& files, const std::filesystem::path& path,
                               const CancelToken& cancel) {
  const auto file = files.open(path);
  storage::Checksum sum;
  std::vector<std::byte> buffer(1 << 20);
  for (std::uint64_t offset = 0;; offset += buffer.size()) {
    cancel.check();
    const std::size_t count = file->read_at(offset, buffer);
    sum.add({buffer.data(), count});
    if (count < buffer.size())
      return sum.value();
  }
}

/// What `config` became, with what does not decide the result.
nlohmann::ordered_json whole_config(const Config& config) {
  nlohmann::ordered_json whole{{"input", config.input.string()},
                               {"output", config.output.string()},
                               {"memory_budget", exact_size_text(config.memory_budget)},
                               {"threads", config.threads}};
  whole.update(resolved_json(config));
  return whole;
}

BuildStats make_stats(const Config& config, const SourceSummary& source, const Tree& tree,
                      const PublishedSummary& published, const DiskNeed& predicted) {
  BuildStats stats;
  stats.config = whole_config(config);
  stats.memory_budget_bytes = config.memory_budget;
  stats.vertices = source.vertices;
  stats.triangles = source.triangles;
  stats.partitions = tree.partition_count();
  stats.levels = raw(tree.depth()) + 1;
  stats.tiles = published.tiles;
  stats.input_bytes = source.file_bytes;
  stats.output_bytes = published.total_bytes;
  stats.predicted_output_bytes = predicted.output_bytes;
  stats.predicted_temporary_bytes = predicted.temporary_bytes;
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
  configure_allocator();
  const std::size_t threads = config.threads > 0
                                  ? config.threads
                                  : static_cast<std::size_t>(tbb::info::default_concurrency());
  const tbb::global_control thread_limit(tbb::global_control::max_allowed_parallelism, threads);

  // Everything that can be refused is refused before anything is written.
  check_apart(config, files);
  std::unique_ptr<mesh_io::MeshSource> source = mesh_io::open_mesh(files, config.input);
  const Tree tree = plan_tree(config, source->description().vertex_count);
  const JobSize job = job_size(config, source->description(), tree, threads);
  const MemoryPlan plan = plan_memory(config.memory_budget, job);
  const DiskNeed need = predict_disk(job, plan);
  storage::MemoryPool pool(plan.pool_bytes);
  StageMeter progress({environment.progress, files.counters(), pool.scratch_use()});
  storage::WorkDirectory work(files, config.output, force);
  check_disk(need, work.path(), files);

  storage::ScratchFile tile_scratch(files, work.temporary() / "tiles", pool);
  Forest forest(tree, partition::chunk_level(tree), job.channels, tile_scratch);

  PublishInput result;
  {
    storage::ScratchFile mesh_scratch(files, work.temporary() / "mesh", pool);
    SourceMesh mesh(std::move(source), config.input.filename().string(), mesh_scratch, progress,
                    cancel);
    Chunks chunks =
        distribute(mesh, tree, config.partition.axis, plan, mesh_scratch, progress, cancel);
    result.source = mesh.summary();
    progress.begin("checksum");
    result.source.checksum = checksum_of_file(files, config.input, cancel);
    result.format = {mesh.summary().attributes, mesh.origin()};
    result.source.unreferenced_vertices =
        make_leaves(chunks, forest, config.partition.axis, plan, progress, cancel);
  }
  result.asked_vertices = asked_vertices(config, tree);
  result.config = resolved_json(config);
  simplify(forest,
           {result.asked_vertices,
            result.source.attributes,
            {config.simplify.method, config.simplify.representative, config.simplify.cost}},
           plan, progress, cancel);
  measure(forest, config.simplify.method, plan, progress, cancel);
  result.outline =
      make_outline(forest, config.outline,
                   length(result.source.bounds.max - result.source.bounds.min), progress, cancel);
  const PublishedSummary published =
      publish(forest, result, work.path(), plan, files, progress, cancel);
  cancel.check();
  progress.begin("sync");
  work.publish();
  progress.end();

  BuildReport report;
  report.stats = make_stats(config, result.source, tree, published, need);
  report.stats.output_bytes += files.open(storage::manifest_path(config.output))->size();
  report.stats.threads = threads;
  report.stats.peak_temporary_bytes = pool.scratch_use().peak_bytes_on_disk();
  report.stats.stages = progress.stages();
  report.stats.total = progress.total();
  report.text = report_text(result.source, report.stats);
  return report;
}

}  // namespace meshhier::pipeline
