// The stages `ingest` and `partition`, which are one step of a build: from the input to chunks.
#pragma once

#include "import/mesh_input.h"
#include "partition/top_tree.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/plan/stage_context.h"

#include <optional>
#include <vector>

namespace meshhier::pipeline {

/// Reads the input, or the mesh that it was imported to, distributes it to chunks and notes the
/// source. Throws as ingest() and partition_mesh(), and Error(usage) if there is no place for the
/// tileset.
void read_mesh(importing::MeshInput& input, Workshop& workshop, const StageContext& context);

/// The facts of a whole input that its slices need, besides the source.
struct InputSplits {
  partition::TopTree top;
  std::vector<storage::BlockSums> sums;         ///< checksums of the blocks that were read
  std::vector<importing::StoredCopies> copies;  ///< in the workshop's scratch file of the mesh
};

/// Reads the vertices and notes the source, without its faces and its checksum: the slices do the
/// rest (slice_stage.h). Returns nothing if the input has no slices, as it was imported or its
/// vertices are not in place; then it has done all that read_mesh() does.
std::optional<InputSplits> read_splits(importing::MeshInput& input, Workshop& workshop,
                                       const StageContext& context);

/// Notes the source when all of it is read. Throws Error(input) if it was changed meanwhile.
void note_source(SourceMesh& mesh, const mesh_io::FaceCounts& counts,
                 const importing::MeshInput& input, Workshop& workshop,
                 const StageContext& context);

}  // namespace meshhier::pipeline
