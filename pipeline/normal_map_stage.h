// The stage `normal maps`: simplified tiles of a mesh without pictures are lit by normal maps.
//
// They are made level by level, from the tiles that a tile and its neighbours were made of;
// partitions have their own normals. The stage takes the place of the stage `texture`, and the
// store of its pictures.
#pragma once

#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"

namespace meshhier::pipeline {

/// The stage's memory; items are tiles, with their maps. It and the next ones require a build that
/// makes maps.
StageMemory normal_map_memory(const JobSize& job);
/// Returns about how many bytes the published maps have, with tangents and coordinates; for any
/// build.
double published_map_bytes(const JobSize& job, const TilePopulation& tiles);
StageTimes normal_map_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: maps and directions of tiles, until the end.
DiskVolumes normal_map_disk(const JobSize& job, const TilePopulation& tiles,
                            const MemoryPlan& memory);

/// Makes the maps of simplified tiles that the journal does not have, level by level from the last
/// on, and notes them. Requires all tiles of level `end`, and those of the whole levels between if
/// there are any. Deterministic for any number of threads. Throws Error(io | interrupted | budget).
void make_normal_maps(const Forest& forest, TextureStore& textures, BuildJournal& journal,
                      const LevelRange& levels, const StageContext& context);

}  // namespace meshhier::pipeline
