// The costs of all stages of a build (pipeline/stages.h), and the plan that follows from them.
//
// Data is written, and stays on disk:
//
//   data                    written in     stays until
//   the input as a PLY      import         partition is done   if it is imported
//   its vertices once more  ingest         partition is done   only if they cannot be read in place
//   windows of the medians  partition      the splits are found
//   ranks, triangles that   partition      partition is done
//   wait for a rank
//   vertices, triangles     partition      leaves is done
//   of chunks
//   partition tiles         leaves         the end
//   simplified tiles, maps  simplify       the end
//   seam strips, normals    simplify       the end
//   published files         publish        for good            if they are the output
//                                          the end             if they are packed, the data above
//                                          being gone
//   the archive             pack           for good
#pragma once

#include "config/config.h"
#include "mesh_io/mesh_source.h"
#include "pipeline/plan/build_plan.h"
#include "pipeline/plan/job_size.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/plan/stage_cost.h"
#include "pipeline/plan/tile_population.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::pipeline {

MemoryCosts memory_costs(const JobSize& job);

/// `tiles`: expected_tiles(job), or better known ones.
DiskCosts disk_costs(const JobSize& job, const MemoryPlan& memory, const TilePopulation& tiles);

/// CPU seconds of a whole build for each triangle of the input, about: for estimates before a mesh
/// is known.
inline constexpr double kBuildTriangleSeconds = 1.4e-6;

/// Returns the CPU seconds of all stages from ingest to publish, in the order of a build.
StageTimes cpu_times(const BuildPlan& plan);

/// Returns the wall seconds of a build's work on so many threads; one thread does a part of it
/// while the others wait.
double wall_seconds(double cpu_seconds, std::size_t threads);

/// Returns the wall seconds of all stages to the end, import left out.
StageTimes wall_times(const BuildPlan& plan);

/// Returns the need of disk when all partitions are there, if these take far more than was expected
/// from the header: around vertices of very many triangles, or in a soup. Else returns nothing.
std::optional<DiskNeed> refine_disk(const BuildPlan& plan, const storage::TileSums& partitions);

/// Returns the need of disk when all normals are there: `need` did not count vertices that are
/// split at creases.
DiskNeed with_splits(const BuildPlan& plan, const DiskNeed& need, std::uint64_t splits);

/// Returns the plan for a mesh of which the header was read; `imported` as in job_size().
/// Throws as plan_tree(), and Error(budget) if the memory budget is too small.
BuildPlan plan_build(const config::Config& config, const mesh_io::MeshDescription& mesh,
                     const ImportedBytes& imported = {}, TexturePlan textures = {});

}  // namespace meshhier::pipeline
