// The stage `partition`, upper part: vertices and triangles distributed to chunks.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/tree.h"
#include "partition/direction.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/source_mesh.h"
#include "pipeline/tiles/chunks.h"
#include "storage/io/spool.h"

namespace meshhier::pipeline {

/// Finds the exact splits above the chunks, then distributes the vertices in one pass and the
/// triangles in one. What is needed meanwhile only is beside `scratch`.
void distribute(SourceMesh& mesh, const Tree& tree, partition::Axis axis, Chunks& chunks,
                const MemoryPlan& plan, storage::ScratchFile& scratch,
                execution::Progress& progress, const execution::CancelToken& cancel);

}  // namespace meshhier::pipeline
