// The format of a build's published tiles.
#pragma once

#include "hierarchy/object_row.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/texture_store.h"
#include "storage/format/tile_glb.h"

#include <vector>

namespace meshhier::pipeline {

/// Returns the format. `objects`: the properties of their table, if tiles have tables of theirs.
storage::TileFormat format_of(const DistributedSource& source, bool computed_normals,
                              const TextureStore& textures,
                              const std::vector<ObjectProperty>* objects,
                              const StageContext& context);

}  // namespace meshhier::pipeline
