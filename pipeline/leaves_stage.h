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
StageTimes leaves_time(const JobSize& job, const TilePopulation& tiles);
/// Partition tiles, until the end.
DiskVolumes leaves_disk(const JobSize& job, const TilePopulation& tiles, const MemoryPlan& memory);

/// Throws if not all of the share's chunks, which other processes have distributed, are there:
/// Error(corrupt) that names the file, or Error(io).
void check_chunks(const Chunks& chunks, const Share& share, const execution::CancelToken& cancel);

/// Splits every chunk of the share and puts its partition tiles into the forest, but for those
/// whose leaves the journal has. Throws Error(budget) for a chunk with more triangles than there is
/// memory for.
void make_leaves(Chunks& chunks, Forest& forest, BuildJournal& journal, const Share& share,
                 const StageContext& context);

}  // namespace meshhier::pipeline
