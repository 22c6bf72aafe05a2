// The stage `publish`: tiles as GLB, the index, the outline and the manifest.
#pragma once

#include "hierarchy/frame.h"
#include "hierarchy/published.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/outline_stage.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/bound_chain.h"
#include "pipeline/tiles/forest.h"

#include <filesystem>

namespace meshhier::pipeline {

/// The published files, for good or until they are packed.
OutputCost publish_output(const JobSize& job, const TilePopulation& tiles);
StageTime publish_time(const JobSize& job, const TilePopulation& tiles);

/// What earlier stages learnt and the published files tell.
struct PublishInput {
  SourceSummary source;
  Vec3d origin;  ///< add to positions to get input coordinates
  TileErrors errors;
  OutlineStageResult outline;
};

/// Writes the whole hierarchy into `directory`, but for tiles that the journal has there.
void publish(Forest& forest, const TextureStore& textures, BuildJournal& journal,
             const PublishInput& input, const std::filesystem::path& directory,
             const StageContext& context);

}  // namespace meshhier::pipeline
