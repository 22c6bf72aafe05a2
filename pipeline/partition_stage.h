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

/// What chunks are spooled to.
ChunkSpools chunk_spools(const JobSize& job);

/// Items are blocks of input.
StageMemory partition_memory(const JobSize& job);
/// A sweep for the splits, then vertices and triangles distributed.
StageTimes partition_time(const JobSize& job, const TilePopulation& tiles);
/// Windows of the medians until the splits are found; ranks, and triangles that wait for one, while
/// triangles are distributed; chunks until the end of `leaves`.
DiskVolumes partition_disk(const JobSize& job, const TilePopulation& tiles,
                           const MemoryPlan& memory);

/// Finds the exact splits above the chunks, then distributes the vertices in one pass and the
/// triangles in one; returns how many faces the mesh has. What is needed meanwhile only is beside
/// `scratch`, here and below.
mesh_io::FaceCounts partition_mesh(SourceMesh& mesh, const importing::CopyList& copies,
                                   Chunks& chunks, storage::ScratchFile& scratch,
                                   const StageContext& context);

/// Finds the splits alone.
partition::TopTree find_splits(SourceMesh& mesh, const importing::CopyList& copies,
                               storage::ScratchFile& scratch, const StageContext& context);

/// When all triangles are distributed: the stage that would be refused comes late, and takes long
/// where triangles reach across.
void warn_of_wide_triangles(const Chunks& chunks, const StageContext& context);

}  // namespace meshhier::pipeline
