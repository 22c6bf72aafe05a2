// The stage `images`: all pictures of the input, decoded into scratch space.
#pragma once

#include "images/image_store.h"
#include "images/material_list.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"

#include <string>
#include <vector>

namespace meshhier::pipeline {

/// Items are pictures. Requires a textured mesh, as all that is told of the stage.
StageMemory images_memory(const JobSize& job);
StageTimes images_time(const JobSize& job, const TilePopulation& tiles);
/// Decoded pictures, until the partitions have theirs.
DiskVolumes images_disk(const JobSize& job, const TilePopulation& tiles, const MemoryPlan& memory);

/// Why pictures are left out that are there, a sentence each; each once.
std::vector<std::string> broken_pictures(const TexturePlan& plan, const BuildJournal& journal);

/// Decodes all pictures that the journal does not have; throws Error(input) if one is not what it
/// was when the input was read. With `missing_images` ignore, the journal has of those that turn
/// out to be broken why they are; else throws Error(input) that names one.
void decode_images(images::ImageStore& pictures, BuildJournal& journal,
                   const StageContext& context);

/// The materials with the pictures that are there, when all are decoded.
images::MaterialList shown_materials(const TexturePlan& plan, const BuildJournal& journal);

}  // namespace meshhier::pipeline
