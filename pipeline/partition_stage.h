// The stage `partition`, upper part: vertices and triangles distributed to chunks.
#pragma once

#include "mesh_io/mesh_source.h"
#include "partition/top_tree.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/chunks.h"
#include "storage/io/spool.h"

#include <vector>

namespace meshhier::pipeline {

/// Returns the spools that all chunks together have.
ChunkSpools chunk_spools(const JobSize& job);

/// The stage's memory; items are blocks of input.
StageMemory partition_memory(const JobSize& job);
/// The stage's time: a sweep for the splits, then vertices and triangles are distributed.
StageTimes partition_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: windows of the medians until the splits are found; ranks, and triangles that
/// wait for one, while triangles are distributed; chunks until the end of `leaves`.
DiskVolumes partition_disk(const JobSize& job, const TilePopulation& tiles,
                           const MemoryPlan& memory);

/// Finds the exact splits above the chunks, then distributes the vertices in one pass and the
/// triangles in one; returns how many faces the mesh has. Files that are needed only meanwhile lie
/// beside `scratch`, here and below. Deterministic for any number of threads and any budget. Throws
/// as SourceMesh, and Error(io).
mesh_io::FaceCounts partition_mesh(SourceMesh& mesh, const importing::CopyList& copies,
                                   Chunks& chunks, storage::ScratchFile& scratch,
                                   const StageContext& context);

/// Finds the splits alone.
partition::TopTree find_splits(SourceMesh& mesh, const importing::CopyList& copies,
                               storage::ScratchFile& scratch, const StageContext& context);

/// Warns, when all triangles are distributed, if so many reach across the mesh that a later stage
/// takes long, or may be refused for lack of memory.
void warn_of_wide_triangles(const Chunks& chunks, const StageContext& context);

}  // namespace meshhier::pipeline
