// The stage `publish`: tiles as GLB.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"
#include "storage/io/spool.h"

#include <filesystem>

namespace meshhier::pipeline {

/// Returns the bytes of the published files, which stay for good or until they are packed.
OutputCost publish_output(const JobSize& job, const TilePopulation& tiles);
/// The stage's memory: that of the preview or the first view, as tiles on their way take less than
/// in `simplify`.
StageMemory publish_memory(const JobSize& job);
/// The largest of the sorts of objects.
DiskVolumes publish_disk(const JobSize& job, const TilePopulation& tiles, const MemoryPlan& memory);
StageTimes publish_time(const JobSize& job, const TilePopulation& tiles);

/// The directories that tile files go to.
struct TileFiles {
  std::filesystem::path directory;  ///< the hierarchy's
  /// Each file is here until it is whole and on disk, as other processes may write the same. Empty:
  /// it is written in its place.
  std::filesystem::path attempts{};
};

/// Writes the files of the share of all tiles, but for those the journal has, and notes them. If
/// `to.attempts` is given, all are on disk when it returns. Requires all tiles, their pictures and
/// maps. Objects wait for their tiles in a file beside `scratch`. The bytes are the same for any
/// number of threads. Throws Error(io | budget | interrupted).
void publish(Forest& forest, const TextureStore& textures, BuildJournal& journal,
             const TileFiles& to, const Share& share, const storage::ScratchFile& scratch,
             const StageContext& context);

}  // namespace meshhier::pipeline
