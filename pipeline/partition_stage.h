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

/// Finds the exact splits above the chunks, then distributes the vertices in one pass and the
/// triangles in one; returns how many faces the mesh has. What is needed meanwhile only is beside
/// `scratch`, here and below.
mesh_io::FaceCounts partition_mesh(SourceMesh& mesh, const importing::CopyList& copies,
                                   Chunks& chunks, storage::ScratchFile& scratch,
                                   const StageContext& context);

/// Finds the splits alone.
partition::TopTree find_splits(SourceMesh& mesh, const importing::CopyList& copies,
                               storage::ScratchFile& scratch, const StageContext& context);

// The rest in slices of a mesh whose vertices are in place: first the vertices of all slices; then,
// with the ranks of all of them, copies and triangles of all slices; and at last the faces that no
// slice could take.

/// What slices work with.
struct SlicedInput {
  SourceMesh& mesh;
  const importing::CopyList& copies;
  SlicedRanks& ranks;
};

/// Distributes the places of a slice of the blocks and notes their ranks. Rows of copies wait in
/// `copy_rows`.
void distribute_vertices(SlicedInput& input, const partition::TopTree& top, const Share& slice,
                         Chunks& chunks, storage::RecordSpool<float>& copy_rows,
                         const StageContext& context);

/// Distributes the copies of a slice, whose rows wait.
void distribute_copies(SlicedInput& input, const Share& slice,
                       const storage::RecordSpool<float>& copy_rows, Chunks& chunks,
                       storage::ScratchFile& scratch, const StageContext& context);

/// Distributes the triangles of a slice of the blocks, as SourceMesh::read_triangle_blocks(). Reads
/// the faces twice, and of the ranks those from the least vertex that they name to the greatest.
FaceBlocks distribute_triangles(SlicedInput& input, const Share& slice, Chunks& chunks,
                                storage::ScratchFile& scratch, const StageContext& context);

/// Distributes the triangles of all faces from that one on, as SourceMesh::read_triangles_from().
mesh_io::FaceCounts distribute_triangles_from(std::uint64_t face, SlicedInput& input,
                                              Chunks& chunks, storage::ScratchFile& scratch,
                                              const StageContext& context);

/// When all triangles are distributed: the stage that would be refused comes late, and takes long
/// where triangles reach across.
void warn_of_wide_triangles(const Chunks& chunks, const StageContext& context);

}  // namespace meshhier::pipeline
