// The stage `measure`: how far every simplified tile is from the original surface.
#pragma once

#include "cluster_simplify/contraction.h"
#include "pipeline/cancel.h"
#include "pipeline/forest.h"
#include "pipeline/memory_plan.h"
#include "pipeline/progress.h"

namespace meshhier::pipeline {

/// Sets error and bound of every tile, from the partitions (0) to the root, each more than its
/// children's.
///
/// Each tile is measured against its children, joined, with two rows of the neighbours' triangles
/// around them (cluster_simplify/deviation.h), when all tiles of both levels are finished. `bound`
/// sums the certain distances of the steps along every way a point may have taken, through the tile
/// itself and its neighbours; `error` adds the steps' root mean squares up the tree. A step's
/// distance includes pieces of the surface that are no longer drawn. Tiles are read once more, on
/// all threads.
///
/// After the method `cluster`, which folds the surface, steps are judged by the vertices' motion
/// (cluster_simplify/motion.h).
void measure(Forest& forest, cluster_simplify::Method method, const MemoryPlan& plan,
             Progress& progress, const CancelToken& cancel);

}  // namespace meshhier::pipeline
