// The stage `publish`: tiles as GLB, then the index, the outline and the manifest.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/outline_stage.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"

#include <filesystem>

namespace meshhier::pipeline {

/// The published files, for good or until they are packed.
OutputCost publish_output(const JobSize& job, const TilePopulation& tiles);
StageTime publish_time(const JobSize& job, const TilePopulation& tiles);

/// Writes the files of all tiles into `directory`, but for those the journal has.
void publish(Forest& forest, const TextureStore& textures, BuildJournal& journal,
             const std::filesystem::path& directory, const StageContext& context);

/// Writes all other files of the hierarchy, once all tiles are there, and adds up their errors and
/// bounds.
void write_account(Forest& forest, const TextureStore& textures, BuildJournal& journal,
                   const OutlineStageResult& outline, const std::filesystem::path& directory,
                   const StageContext& context);

}  // namespace meshhier::pipeline
