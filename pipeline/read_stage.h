// The stages `ingest` and `partition`, which are one step of a build: from the input to chunks.
#pragma once

#include "import/mesh_input.h"
#include "pipeline/journal/workshop.h"
#include "pipeline/plan/stage_context.h"

namespace meshhier::pipeline {

/// Reads the input, or what it was imported to, distributes it to chunks and notes the source.
/// Throws as ingest() and partition_mesh(), and Error(usage) if there is no place for the tileset.
void read_mesh(importing::MeshInput& input, Workshop& workshop, const StageContext& context);

}  // namespace meshhier::pipeline
