// The stage `normal maps`: what simplified tiles of a mesh without pictures are lit by.
//
// Level by level, from the tiles that a tile and its neighbours were made of; partitions have their
// own normals. It takes the place of the stage `texture`, and the store of its pictures.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"

namespace meshhier::pipeline {

/// Items are tiles, with their maps. Requires a build that makes maps, as all that is told of the
/// stage.
StageMemory normal_map_memory(const JobSize& job);
/// Bytes of the published maps, with tangents and coordinates, about; of any build.
double published_map_bytes(const JobSize& job, const TilePopulation& tiles);
StageTimes normal_map_time(const JobSize& job, const TilePopulation& tiles);
/// Maps and directions of tiles, until the end.
DiskVolumes normal_map_disk(const JobSize& job, const TilePopulation& tiles,
                            const MemoryPlan& memory);

/// Makes the maps of simplified tiles that the journal does not have, level by level from the last
/// on. Requires all of level `end`, and those of the whole levels between if there are any.
void make_normal_maps(const Forest& forest, TextureStore& textures, BuildJournal& journal,
                      const LevelRange& levels, const StageContext& context);

}  // namespace meshhier::pipeline
