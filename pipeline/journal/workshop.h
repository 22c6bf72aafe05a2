// What a build works on: chunks, forest and their scratch files, with the journal of what is done.
#pragma once

#include "execution/cancel.h"
#include "import/mesh_input.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/chunks.h"
#include "pipeline/tiles/forest.h"
#include "storage/format/work_directory.h"
#include "storage/io/spool.h"

#include <memory>
#include <optional>
#include <string>

namespace meshhier::pipeline {

struct Workshop {
  Workshop(const std::filesystem::path& work, const BuildIdentity& identity,
           const AttributeLayout& layout, storage::MemoryPool& pool, const StageContext& context);

  storage::ScratchFile mesh_scratch;  ///< what is needed until the leaves are done
  storage::ScratchFile tile_scratch;
  storage::ScratchFile picture_scratch;  ///< what is needed until the textures are done
  Chunks chunks;
  Forest forest;
  TextureStore textures;
  images::ImageStore pictures;
  BuildJournal journal;
};

struct OpenWorkshop {
  std::unique_ptr<Workshop> workshop;
  std::string found;  ///< for people: what was done already, or why it was of no use; may be empty
};

/// Opens what an earlier build of the same result left in `work`, if it can be gone on with; else
/// empties it. Reads all that was done, to check it, and all of `input` if it was touched since.
/// Throws Error(exists) as BuildJournal does, Error(io).
OpenWorkshop open_workshop(storage::WorkDirectory& work, importing::MeshInput& input,
                           storage::MemoryPool& pool, const StageContext& context);

/// What reading `input` would find out, from an earlier build of the same files; none if it was
/// of others or if they were read in another way. Reads them all if they were touched since.
std::optional<mesh_io::MeshDescription> recall_import(const EarlierBuild& earlier,
                                                      importing::MeshInput& input,
                                                      const config::Config& asked,
                                                      const execution::CancelToken& cancel);

}  // namespace meshhier::pipeline
