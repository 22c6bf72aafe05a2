// The stage `leaves`: partition tiles out of chunks.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/chunks.h"
#include "pipeline/tiles/forest.h"

#include <cstdint>

namespace meshhier::pipeline {

/// Items are chunks.
StageMemory leaves_memory(const JobSize& job);
StageTime leaves_time(const JobSize& job);
/// Partition tiles, until the end.
DiskVolumes leaves_disk(const JobSize& job, const TilePopulation& tiles);

/// Splits every chunk and puts its partition tiles into the forest, but for those whose leaves the
/// journal has. Returns how many vertices no triangle uses. Throws Error(budget) for a chunk with
/// more triangles than there is memory for.
std::uint64_t make_leaves(Chunks& chunks, Forest& forest, BuildJournal& journal,
                          const StageContext& context);

}  // namespace meshhier::pipeline
