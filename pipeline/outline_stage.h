// The stage `outline`: the shape-outline out of the simplified tiles of one level.
#pragma once

#include "config/config.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/outline.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/tiles/forest.h"

namespace meshhier::pipeline {

struct OutlineStageResult {
  Outline outline;
  OutlineReport report;
};

/// `diagonal`: of the model's bounding box.
OutlineStageResult make_outline(Forest& forest, const config::OutlineConfig& config,
                                double diagonal, const MemoryPlan& plan,
                                execution::Progress& progress,
                                const execution::CancelToken& cancel);

}  // namespace meshhier::pipeline
