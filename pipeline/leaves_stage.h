// The stage `leaves`: partition tiles out of chunks.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/chunks.h"
#include "pipeline/tiles/forest.h"

namespace meshhier::pipeline {

/// The stage's memory; items are chunks.
StageMemory leaves_memory(const JobSize& job);
StageTimes leaves_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: partition tiles, until the end.
DiskVolumes leaves_disk(const JobSize& job, const TilePopulation& tiles, const MemoryPlan& memory);

/// Checks that all of the share's chunks, which other processes have distributed, are there and as
/// they were written. Throws Error(corrupt) that names the file, or Error(io).
void check_chunks(const Chunks& chunks, const Share& share, const execution::CancelToken& cancel);

/// Splits every chunk of the share, puts its partition tiles into the forest and notes that, but
/// for chunks whose leaves the journal has. Deterministic for any number of threads. Throws
/// Error(budget) for a chunk with more triangles than there is memory for, Error(io | interrupted).
void make_leaves(Chunks& chunks, Forest& forest, BuildJournal& journal, const Share& share,
                 const StageContext& context);

}  // namespace meshhier::pipeline
