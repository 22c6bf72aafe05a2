// The stages `leaves` and `simplify`: partition tiles out of chunks, then level by level up to the
// root.
#pragma once

#include "cluster_simplify/contraction.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/target_vertex_counts.h"
#include "partition/direction.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/partition_stage.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/tiles/forest.h"

namespace meshhier::pipeline {

/// Splits every chunk and puts its partition tiles into the forest, but for those whose leaves the
/// journal has. Returns how many vertices no triangle uses.
std::uint64_t make_leaves(Chunks& chunks, Forest& forest, BuildJournal& journal,
                          partition::Axis axis, const MemoryPlan& plan,
                          execution::Progress& progress, const execution::CancelToken& cancel);

struct SimplifyOptions {
  TargetVertexCounts vertices;
  AttributeLayout attributes;
  cluster_simplify::ContractionOptions contraction;
  double diagonal = 0;  ///< of the whole model
};

/// Contracts all levels, from the partitions to one root tile, and sets error and bound of every
/// tile, from the partitions (0) to the root, each more than its children's. Tiles that the journal
/// has are not made again.
///
/// How far a contraction moves the surface is measured while it is carried out (deviation.h), and
/// at the seams when its level is complete (seam strip.h). `bound` sums the certain distances of
/// the steps along every way a point may have taken, through the tile itself and its neighbours
/// (bound_chain.h); `error` adds the steps' root mean squares up the tree.
void simplify(Forest& forest, BuildJournal& journal, const SimplifyOptions& options,
              const MemoryPlan& plan, execution::Progress& progress,
              const execution::CancelToken& cancel);

}  // namespace meshhier::pipeline
