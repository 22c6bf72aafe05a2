// The stage `simplify`: tiles level by level, from the partitions up to the root.
#pragma once

#include "hierarchy/published.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/bound_chain.h"
#include "pipeline/tiles/forest.h"

namespace meshhier::pipeline {

/// Items are pairs of children and their parent.
StageMemory simplify_memory(const JobSize& job);
StageTime simplify_time(const JobSize& job, const TilePopulation& tiles);
/// Simplified tiles, parent maps and seam strips, until the end.
DiskVolumes simplify_disk(const JobSize& job, const TilePopulation& tiles);

/// Contracts all levels, from the partitions to one root tile, and returns error and bound of every
/// tile, from the partitions (0) to the root, each more than its children's. Tiles that the journal
/// has are not made again. If normals are computed, every tile gets those of its own surface
/// (shading/own_normals.h).
///
/// How far a contraction moves the surface is measured while it is carried out (deviation.h), and
/// at the seams when its level is complete (seam_strip.h). `bound` sums the certain distances of
/// the steps along every way a point may have taken, through the tile itself and its neighbours
/// (bound_chain.h); `error` adds the steps' root mean squares up the tree.
TileErrors simplify(Forest& forest, BuildJournal& journal, const SourceSummary& source,
                    const StageContext& context);

}  // namespace meshhier::pipeline
