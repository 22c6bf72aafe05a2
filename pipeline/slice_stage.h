// The stage `partition` behind the splits, in slices of a mesh whose vertices are in place: first
// the vertices of all slices; then, with the ranks of all of them, copies and triangles of all
// slices; and at last the faces that no slice could take. Together they make the chunks of
// partition_mesh(), and throw as it does. Files that are needed only meanwhile lie beside
// `scratch`.
#pragma once

#include "import/copy_list.h"
#include "mesh_io/mesh_source.h"
#include "partition/top_tree.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/sliced_ranks.h"
#include "pipeline/tiles/chunks.h"
#include "storage/io/spool.h"

#include <cstdint>

namespace meshhier::pipeline {

/// All that a slice works with.
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

/// Distributes the triangles of a slice of the blocks, and returns what
/// SourceMesh::read_triangle_blocks() does. Reads the faces twice, and little more of the ranks
/// than those of the vertices that they name.
FaceBlocks distribute_triangles(SlicedInput& input, const Share& slice, Chunks& chunks,
                                storage::ScratchFile& scratch, const StageContext& context);

/// Distributes the triangles of all faces from that one on, and returns what
/// SourceMesh::read_triangles_from() does.
mesh_io::FaceCounts distribute_triangles_from(std::uint64_t face, SlicedInput& input,
                                              Chunks& chunks, storage::ScratchFile& scratch,
                                              const StageContext& context);

}  // namespace meshhier::pipeline
