// The stage `objects`: what the import knew of the objects, with what their triangles tell.
#pragma once

#include "hierarchy/published.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"
#include "storage/format/manifest.h"
#include "storage/io/spool.h"

#include <filesystem>

namespace meshhier::pipeline {

StageTimes objects_time(const JobSize& job, const TilePopulation& tiles);

/// Writes the table of objects of the hierarchy in `directory`: the rows of the table `imported`,
/// with boxes, areas and counts of triangles from the partitions. Also counts the objects that each
/// level shows. Requires all tiles. Reads each tile once; sorts a record for each object of a tile,
/// in `scratch`. `origin`: of the tiles' positions. Throws Error(corrupt) if a triangle belongs to
/// no object of the table, Error(io | budget | interrupted).
storage::ObjectsSummary make_objects(Forest& forest, Vec3d origin,
                                     const std::filesystem::path& imported,
                                     const std::filesystem::path& directory,
                                     storage::ScratchFile& scratch, const StageContext& context);

}  // namespace meshhier::pipeline
