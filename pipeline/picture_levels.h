// The frame of the stages that make tiles' pictures and normal maps level by level.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/texture_store.h"

#include <functional>

namespace meshhier::pipeline {

/// Calls make(node) for each tile of the levels whose picture the journal does not have, from the
/// last level on, in parallel within one, and notes it. `name`: the stage's. Throws what make()
/// throws, Error(io | interrupted).
void make_level_by_level(const char* name, const LevelRange& levels, TextureStore& textures,
                         BuildJournal& journal, const StageContext& context,
                         const std::function<void(NodeId node)>& make);

}  // namespace meshhier::pipeline
