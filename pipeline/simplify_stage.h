// The stage `simplify`: tiles level by level, from the partitions up to the root.
#pragma once

#include "hierarchy/published.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/bound_chain.h"
#include "pipeline/tiles/forest.h"

namespace meshhier::pipeline {

/// The stage's memory; items are pairs of children and their parent.
StageMemory simplify_memory(const JobSize& job);
StageTimes simplify_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: simplified tiles, parent maps and seam strips, until the end.
DiskVolumes simplify_disk(const JobSize& job, const TilePopulation& tiles,
                          const MemoryPlan& memory);

/// Contracts, level by level from the last above the partitions to the top one, the tiles that the
/// journal does not have, and notes them. `attributes`: the input's. Requires all tiles of level
/// `end`, and those of the whole levels between if there are any. If normals are computed, every
/// tile that is read gets those of its own surface (shading/own_normals.h); the root, if it is
/// made, too. Deterministic for any number of threads. Throws Error(io | budget | interrupted).
///
/// The distance that a contraction moves the surface is measured while it is carried out
/// (deviation.h), and at the seams when its level is complete (seam_strip.h): such steps are noted
/// in the journal.
void simplify(Forest& forest, BuildJournal& journal, const AttributeLayout& attributes,
              const LevelRange& levels, const StageContext& context);

/// Returns error and bound of every tile, from the partitions (0) to the root, each more than its
/// children's. Requires that all tiles and the root are noted; takes their steps from the journal.
///
/// `bound` sums the certain distances of the steps along every way a point may have taken, through
/// the tile itself and its neighbours (bound_chain.h); `error` adds the steps' root mean squares up
/// the tree. `diagonal`: that of the input's bounds.
TileErrors add_up(BuildJournal& journal, const Tree& tree, double diagonal);

}  // namespace meshhier::pipeline
