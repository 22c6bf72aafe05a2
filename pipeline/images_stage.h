// The stage `images`: all pictures of the input, decoded into scratch space.
#pragma once

#include "images/image_store.h"
#include "images/material_list.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/stage_context.h"

#include <string>
#include <vector>

namespace meshhier::pipeline {

/// One picture is decoded at a time, beside the store's cache. None if there are no textures.
StageMemory images_memory(const JobSize& job);
StageTime images_time(const JobSize& job);

/// Why pictures are left out that are there, a sentence each; each once.
std::vector<std::string> broken_pictures(const TexturePlan& plan, const BuildJournal& journal);

/// Decodes all pictures that the journal does not have; throws Error(input) if one is not what it
/// was when the input was read. Returns the materials with the pictures that are there: with
/// `missing_images` ignore, those that turn out to be broken are left out, and the journal has why;
/// else throws Error(input) that names one.
images::MaterialList decode_images(images::ImageStore& pictures, BuildJournal& journal,
                                   const StageContext& context);

}  // namespace meshhier::pipeline
