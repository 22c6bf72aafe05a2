// The stage `normal maps`: simplified tiles of a mesh without pictures are lit by normal maps.
//
// They are made level by level, from the tiles that a tile and its neighbours were made of;
// partitions have their own normals. Where the finest simplified levels get none, the first level
// with maps is made from the partitions. The stage takes the place of the stage `texture`, and the
// store of its pictures. Where there are pictures, that stage makes both on the same charts.
#pragma once

#include "hierarchy/texture.h"
#include "images/image.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"

namespace meshhier::pipeline {

/// Memory of a triangle at work: as in the stage `texture`, and its frames.
inline constexpr std::uint64_t kFramedTriangleBytes = 600;
/// Returns the memory of a map at work, and of the directions that it is made of.
std::uint64_t map_bytes(std::uint32_t side);
/// Returns the size of the texels of a map that has as many as the original has to show there, at
/// most. `source`: the node's tile.
float finest_map_texel(const Forest& forest, NodeId node, const BakeSource& source);
TileImage encoded_map(const images::Image& map, const NormalMapFormat& format);

/// The stage's memory; items are tiles, with their maps. It and the last ones require a build
/// that makes maps.
StageMemory normal_map_memory(const JobSize& job);
/// Returns about how many bytes the published maps have, with tangents and coordinates; for any
/// build.
double published_map_bytes(const JobSize& job, const TilePopulation& tiles);
/// Returns about the seconds that the maps take, and their scratch space, until the end, with the
/// directions; for any build.
double map_seconds(const JobSize& job, const TilePopulation& tiles);
double map_scratch_bytes(const JobSize& job, const TilePopulation& tiles);
StageTimes normal_map_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: map_scratch_bytes().
DiskVolumes normal_map_disk(const JobSize& job, const TilePopulation& tiles,
                            const MemoryPlan& memory);

/// Makes the maps of simplified tiles that the journal does not have, level by level from the last
/// on, and notes them. Requires all tiles of the forest, and the maps of level `end` if it has any.
/// Deterministic for any number of threads. Throws Error(io | interrupted | budget).
void make_normal_maps(const Forest& forest, TextureStore& textures, BuildJournal& journal,
                      const LevelRange& levels, const StageContext& context);

}  // namespace meshhier::pipeline
