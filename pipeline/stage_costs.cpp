#include "pipeline/stage_costs.h"

#include "config/placement.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/leaves_stage.h"
#include "pipeline/pack_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/publish_stage.h"
#include "pipeline/stages.h"
#include "storage/format/archive_writer.h"
#include "storage/format/tile_plan.h"

namespace meshhier::pipeline {
namespace {

/// Returns the memory of what several stages keep about each tile until the end, of the archive's
/// index, of what the input's reader holds, and of PROJ.
std::uint64_t bookkeeping_bytes(const JobSize& job) {
  // A tile has six blob entries, its record, its statistics, its step and the sums of steps with
  // some twenty neighbours each.
  constexpr std::uint64_t kTileBytes = 528;
  const std::uint64_t tiles = 2 * std::uint64_t{job.partition_count};
  return tiles * (kTileBytes + (job.packed ? storage::ArchiveWriter::kFileMemory : 0)) +
         job.held_bytes + (job.has_map ? config::kMapMemoryBytes : 0);
}

/// Returns the times of one kind of all stages that apply.
StageTimes times_of(const BuildPlan& plan,
                    StageTimes (*Stage::*kind)(const JobSize& job, const TilePopulation& tiles)) {
  const TilePopulation tiles = expected_tiles(plan.job);
  StageTimes all;
  for (const Stage* stage : stages_of(plan.job)) {
    if (stage->*kind == nullptr)
      continue;
    const StageTimes times = (stage->*kind)(plan.job, tiles);
    all.insert(all.end(), times.begin(), times.end());
  }
  return all;
}

}  // namespace

MemoryCosts memory_costs(const JobSize& job) {
  MemoryCosts costs{.bookkeeping_bytes = bookkeeping_bytes(job),
                    .chunk_spools = chunk_spools(job),
                    .block_bytes = input_block_bytes(job)};
  for (const Stage* stage : stages_of(job)) {
    if (stage->memory != nullptr)
      costs.stages.push_back(stage->memory(job));
  }
  return costs;
}

DiskCosts disk_costs(const JobSize& job, const MemoryPlan& memory, const TilePopulation& tiles) {
  DiskCosts costs;
  for (const Stage* stage : stages_of(job)) {
    if (stage->disk == nullptr)
      continue;
    const DiskVolumes volumes = stage->disk(job, tiles, memory);
    costs.volumes.insert(costs.volumes.end(), volumes.begin(), volumes.end());
  }
  costs.output = publish_output(job, tiles);
  costs.packed = job.packed;
  costs.archive_overhead_bytes = archive_overhead_bytes(tiles);
  return costs;
}

BuildPlan plan_build(const config::Config& config, const mesh_io::MeshDescription& mesh,
                     const ImportedBytes& imported, TexturePlan textures) {
  const Tree tree = plan_tree(config, mesh.places(), textures);
  const JobSize job = job_size(config, mesh, imported, tree, textures);
  const MemoryPlan memory = plan_memory(memory_budget(config), memory_costs(job));
  const DiskCosts disk = disk_costs(job, memory, expected_tiles(job));
  return {tree,
          job.threads,
          job.target_vertex_counts,
          job,
          memory,
          predict_disk(disk, memory.pool_bytes),
          std::move(textures)};
}

StageTimes cpu_times(const BuildPlan& plan) {
  return times_of(plan, &Stage::time);
}

double wall_seconds(double cpu_seconds, std::size_t threads) {
  constexpr double kSerialShare = 0.06;
  return cpu_seconds * (kSerialShare + (1 - kSerialShare) / static_cast<double>(threads));
}

StageTimes wall_times(const BuildPlan& plan) {
  StageTimes times = cpu_times(plan);
  for (StageTime& stage : times)
    stage.seconds = wall_seconds(stage.seconds, plan.threads);
  const StageTimes waiting = times_of(plan, &Stage::disk_time);
  times.insert(times.end(), waiting.begin(), waiting.end());
  return times;
}

std::optional<DiskNeed> refine_disk(const BuildPlan& plan, const storage::TileSums& partitions) {
  constexpr double kFarMore = 1.25;  // surfaces are within a few per cent
  const JobSize& job = plan.job;
  const TilePopulation expected = expected_tiles(job);
  const TilePopulation counted = with_counted(expected, partitions);
  const auto leaves_bytes = [&](const TilePopulation& tiles) {
    return temporary_bytes_at(DiskMoment::leaves, leaves_disk(job, tiles, plan.memory), 0);
  };
  if (leaves_bytes(counted) <= kFarMore * leaves_bytes(expected))
    return std::nullopt;
  return predict_disk(disk_costs(job, plan.memory, counted), plan.memory.pool_bytes);
}

DiskNeed with_splits(const BuildPlan& plan, const DiskNeed& need, std::uint64_t splits) {
  const JobSize& job = plan.job;
  const storage::TileSums sums = expected_tiles(job).partitions;
  // Ghosts have splits too: more than others, as measured.
  constexpr double kGhostSplits = 1.5;
  const double tiles_per_vertex =
      1 + kGhostSplits * sums.boundary * sums.ghosts_per_boundary / sums.vertices;
  const auto plain =
      static_cast<std::uint64_t>(static_cast<double>(splits) * tiles_per_vertex *
                                 storage::expected_split_bytes(job.published_attribute_bytes));
  DiskNeed all = need;
  all.output_bytes += static_cast<std::uint64_t>(static_cast<double>(plain) * job.published_ratio);
  all.room_bytes += plain * (job.packed ? 2 : 1);
  return all;
}

}  // namespace meshhier::pipeline
