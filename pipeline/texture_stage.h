// The stage `texture`: a picture for each tile of a textured mesh.
//
// Partitions get the input's texels; tiles above them are baked, level by level, from the tiles
// that they and their neighbours were made of.
#pragma once

#include "hierarchy/texture.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/share.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/tiles/bound_chain.h"
#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/leaf_picture.h"
#include "pipeline/tiles/texture_store.h"
#include "texture/leaf_atlas.h"

#include <vector>

namespace meshhier::pipeline {

/// The stage's memory; items are tiles, with their pictures. It and the next ones require a
/// textured mesh.
StageMemory texture_memory(const JobSize& job);
/// Returns about how many bytes the published pictures have; for any mesh.
double published_picture_bytes(const JobSize& job, const TilePopulation& tiles);
StageTimes texture_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: pictures of tiles, until the end.
DiskVolumes texture_disk(const JobSize& job, const TilePopulation& tiles, const MemoryPlan& memory);

/// Makes the pictures of tiles that the journal does not have, level by level from the last on, and
/// notes them. Requires the tiles and pictures of level `end`, and of the whole levels between if
/// there are any; `end` behind the partitions needs none. Deterministic for any number of threads.
/// Throws Error(io | corrupt | budget | interrupted).
void make_textures(const Forest& forest, const TexturedInput& input, TextureStore& textures,
                   BuildJournal& journal, const LevelRange& levels, const StageContext& context);

/// Returns errors that are no smaller than the texels of the tiles, where those are larger than the
/// input's.
TileErrors with_texels(TileErrors errors, const Tree& tree, const TextureStore& textures);

}  // namespace meshhier::pipeline
