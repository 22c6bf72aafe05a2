// The stage `publish`: tiles as GLB, then the index, the outline and the manifest.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/outline_stage.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"

#include <filesystem>

namespace meshhier::pipeline {

/// The published files, for good or until they are packed.
OutputCost publish_output(const JobSize& job, const TilePopulation& tiles);
/// What the preview or the first view holds: tiles on their way take less than in `simplify`.
StageMemory publish_memory(const JobSize& job);
StageTimes publish_time(const JobSize& job, const TilePopulation& tiles);

/// Where tile files go.
struct TileFiles {
  std::filesystem::path directory;  ///< of the hierarchy
  /// Where each is until it is whole and on disk, as other processes may write the same; empty: it
  /// is written in its place.
  std::filesystem::path attempts{};
};

/// Writes the files of the share of all tiles, but for those the journal has. All are on disk then,
/// if other processes write, too.
void publish(Forest& forest, const TextureStore& textures, BuildJournal& journal,
             const TileFiles& to, const Share& share, const StageContext& context);

/// Writes all other files of the hierarchy, once all tiles are there, and adds up their errors and
/// bounds.
void write_account(Forest& forest, const TextureStore& textures, BuildJournal& journal,
                   const OutlineStageResult& outline, const std::filesystem::path& directory,
                   const StageContext& context);

}  // namespace meshhier::pipeline
