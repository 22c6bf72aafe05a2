// The stage `partition`, upper part: vertices and triangles distributed to chunks.
#pragma once

#include "mesh_io/mesh_source.h"
#include "partition/top_tree.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/sliced_ranks.h"
#include "pipeline/tiles/chunks.h"
#include "storage/io/spool.h"

#include <vector>

namespace meshhier::pipeline {

/// What chunks are spooled to.
ChunkSpools chunk_spools(const JobSize& job);

/// Items are blocks of input.
StageMemory partition_memory(const JobSize& job);
/// A sweep for the splits, then vertices and triangles distributed.
std::vector<StageTime> partition_time(const JobSize& job);
/// Windows of the medians until the splits are found; ranks, and triangles that wait for one, while
/// triangles are distributed; chunks until the end of `leaves`.
DiskVolumes partition_disk(const JobSize& job, const MemoryPlan& memory);

/// Finds the exact splits above the chunks. What is needed meanwhile only is beside `scratch`, here
/// and below.
partition::TopTree find_splits(SourceMesh& mesh, const importing::CopyList& copies,
                               storage::ScratchFile& scratch, const StageContext& context);

/// Distributes the vertices in one pass and the triangles in one; returns how many faces the mesh
/// has.
mesh_io::FaceCounts distribute(SourceMesh& mesh, const importing::CopyList& copies,
                               const partition::TopTree& top, Chunks& chunks,
                               storage::ScratchFile& scratch, const StageContext& context);

// The same in slices, of a mesh whose vertices are in place and which has no copies: first the
// vertices of all slices; then, with the ranks of all of them, the triangles of all slices; and at
// last the faces that no slice could take.

/// Distributes the vertices of a slice of the blocks.
void distribute_vertices(const SourceMesh& mesh, const partition::TopTree& top, const Share& slice,
                         Chunks& chunks, SlicedRanks& ranks, const StageContext& context);

/// Distributes the triangles of a slice of the blocks, as SourceMesh::read_triangle_blocks(). Reads
/// the faces twice, and of the ranks those from the least vertex that they name to the greatest.
FaceBlocks distribute_triangles(SourceMesh& mesh, const SlicedRanks& ranks, const Share& slice,
                                Chunks& chunks, storage::ScratchFile& scratch,
                                const StageContext& context);

/// Distributes the triangles of all faces from that one on, as SourceMesh::read_triangles_from().
mesh_io::FaceCounts distribute_triangles_from(std::uint64_t face, SourceMesh& mesh,
                                              const SlicedRanks& ranks, Chunks& chunks,
                                              storage::ScratchFile& scratch,
                                              const StageContext& context);

/// When all triangles are distributed: the stage that would be refused comes late, and takes long
/// where triangles reach across.
void warn_of_wide_triangles(const Chunks& chunks, const StageContext& context);

}  // namespace meshhier::pipeline
