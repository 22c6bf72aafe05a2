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

/// The stage's memory; items are pictures. It and all below require a textured mesh.
StageMemory images_memory(const JobSize& job);
StageTimes images_time(const JobSize& job, const TilePopulation& tiles);
/// The stage's disk: decoded pictures, until the partitions have theirs.
DiskVolumes images_disk(const JobSize& job, const TilePopulation& tiles, const MemoryPlan& memory);

/// Returns why pictures that are there are left out, a sentence each; each once.
std::vector<std::string> broken_pictures(const TexturePlan& plan, const BuildJournal& journal);

/// Decodes all pictures that the journal does not have, and notes them; throws Error(input) if one
/// is not what it was when the input was read. If a picture turns out to be broken, the journal
/// notes why with `missing_images` ignore; else throws Error(input) that names one.
void decode_images(images::ImageStore& pictures, BuildJournal& journal,
                   const StageContext& context);

/// Returns the materials with the pictures that are there, when all are decoded.
images::MaterialList shown_materials(const TexturePlan& plan, const BuildJournal& journal);

}  // namespace meshhier::pipeline
