// The stage `outline`: the shape-outline out of the simplified tiles of one level.
#pragma once

#include "hierarchy/outline.h"
#include "pipeline/cancel.h"
#include "pipeline/config.h"
#include "pipeline/forest.h"
#include "pipeline/memory_plan.h"
#include "pipeline/progress.h"

namespace meshhier::pipeline {

struct OutlineStageResult {
  Outline outline;
  OutlineReport report;
};

/// `diagonal`: of the model's bounding box.
OutlineStageResult make_outline(Forest& forest, const OutlineConfig& config, double diagonal,
                                const MemoryPlan& plan, Progress& progress,
                                const CancelToken& cancel);

}  // namespace meshhier::pipeline
