// What the stages that make tiles' pictures and normal maps have in common: level by level.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/texture_store.h"

#include <functional>

namespace meshhier::pipeline {

/// Calls make(node) for each tile of the levels that the journal has nothing of, from the last
/// level on, in parallel within one, and notes it. `name`: of the stage.
void make_level_by_level(const char* name, const LevelRange& levels, TextureStore& textures,
                         BuildJournal& journal, const StageContext& context,
                         const std::function<void(NodeId node)>& make);

}  // namespace meshhier::pipeline
