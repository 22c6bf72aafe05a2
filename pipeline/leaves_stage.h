// The stage `leaves`: partition tiles out of chunks.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/chunks.h"
#include "pipeline/tiles/forest.h"

namespace meshhier::pipeline {

/// Items are chunks.
StageMemory leaves_memory(const JobSize& job);
StageTime leaves_time(const JobSize& job);
/// Partition tiles, until the end.
DiskVolumes leaves_disk(const JobSize& job, const TilePopulation& tiles);

/// Splits every chunk of the share and puts its partition tiles into the forest, but for those
/// whose leaves the journal has. Throws Error(budget) for a chunk with more triangles than there is
/// memory for, Error(io) if the disk has changed a chunk of another process.
void make_leaves(Chunks& chunks, Forest& forest, BuildJournal& journal, const Share& share,
                 const StageContext& context);

}  // namespace meshhier::pipeline
