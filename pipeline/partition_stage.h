// The stage `partition`, upper part: vertices and triangles distributed to chunks.
#pragma once

#include "hierarchy/tree.h"
#include "partition/direction.h"
#include "pipeline/cancel.h"
#include "pipeline/chunks.h"
#include "pipeline/memory_plan.h"
#include "pipeline/progress.h"
#include "pipeline/source_mesh.h"
#include "storage/spool.h"

namespace meshhier::pipeline {

/// Finds the exact splits above the chunks, then distributes the vertices in one pass and the
/// triangles in one. What is needed meanwhile only is beside `scratch`.
void distribute(SourceMesh& mesh, const Tree& tree, partition::Axis axis, Chunks& chunks,
                const MemoryPlan& plan, storage::ScratchFile& scratch, Progress& progress,
                const CancelToken& cancel);

}  // namespace meshhier::pipeline
