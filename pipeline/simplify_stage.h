// The stages `leaves` and `simplify`: partition tiles out of chunks, then level by level up to the
// root.
#pragma once

#include "cluster_simplify/contraction.h"
#include "partition/direction.h"
#include "pipeline/cancel.h"
#include "pipeline/forest.h"
#include "pipeline/memory_plan.h"
#include "pipeline/partition_stage.h"
#include "pipeline/progress.h"

namespace meshhier::pipeline {

/// Splits every chunk and puts its partition tiles into the forest. Returns how many vertices no
/// triangle uses.
std::uint64_t make_leaves(Chunks& chunks, Forest& forest, partition::Axis axis,
                          const MemoryPlan& plan, Progress& progress, const CancelToken& cancel);

struct SimplifyOptions {
  std::uint32_t vertices = 8192;  ///< asked of every simplified tile
  AttributeLayout attributes;
  cluster_simplify::ContractionOptions contraction;
};

/// Contracts all levels, from the partitions to one root tile.
void simplify(Forest& forest, const SimplifyOptions& options, const MemoryPlan& plan,
              Progress& progress, const CancelToken& cancel);

}  // namespace meshhier::pipeline
