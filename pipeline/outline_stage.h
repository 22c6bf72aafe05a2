// The stage `outline`: the shape-outline out of the simplified tiles of one level.
#pragma once

#include "hierarchy/outline.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/stage_cost.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"

namespace meshhier::pipeline {

StageTimes outline_time(const JobSize& job, const TilePopulation& tiles);

struct OutlineStageResult {
  Outline outline;
  OutlineReport report;
};

/// Makes the outline. Requires the tiles of all levels. Its memory is bounded whatever the budget,
/// and the result the same. `diagonal`: that of the model's bounding box. Throws Error(io |
/// interrupted).
OutlineStageResult make_outline(Forest& forest, double diagonal, const StageContext& context);

}  // namespace meshhier::pipeline
