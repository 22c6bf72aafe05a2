// The stage `account`: the index, the outline, the preview and the manifest, which tell of all
// tiles.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/outline_stage.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"
#include "storage/format/manifest.h"

#include <filesystem>
#include <optional>

namespace meshhier::pipeline {

/// Adds up the errors and bounds of all tiles, which must be published, and writes all other files
/// of the hierarchy; the manifest comes last. `objects`: if the mesh has any. Throws Error(io |
/// corrupt | interrupted).
void write_account(Forest& forest, const TextureStore& textures, BuildJournal& journal,
                   const OutlineStageResult& outline,
                   const std::optional<storage::ObjectsSummary>& objects,
                   const std::filesystem::path& directory, const StageContext& context);

}  // namespace meshhier::pipeline
