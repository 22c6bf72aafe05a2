// What a build works on: chunks, forest and their scratch files, with the journal of what is done.
#pragma once

#include "pipeline/build_input.h"
#include "pipeline/build_journal.h"
#include "pipeline/build_plan.h"
#include "pipeline/cancel.h"
#include "pipeline/chunks.h"
#include "pipeline/config.h"
#include "pipeline/forest.h"
#include "storage/spool.h"
#include "storage/work_directory.h"

#include <memory>
#include <string>

namespace meshhier::pipeline {

struct Workshop {
  Workshop(storage::FileSystem& files, const std::filesystem::path& work, const BuildPlan& build,
           int channels, const BuildIdentity& identity, storage::MemoryPool& pool,
           const CancelToken& cancel);

  storage::ScratchFile mesh_scratch;  ///< what is needed until the leaves are done
  storage::ScratchFile tile_scratch;
  Chunks chunks;
  Forest forest;
  BuildJournal journal;
};

struct OpenWorkshop {
  std::unique_ptr<Workshop> workshop;
  std::string found;  ///< for people: what was done already, or why it was of no use; may be empty
};

/// Opens what an earlier build of the same result left in `work`, if it can be gone on with; else
/// empties it. Reads all that was done, to check it, and all of `input` if it was touched since.
/// Throws Error(exists) as BuildJournal does, Error(io).
OpenWorkshop open_workshop(storage::FileSystem& files, storage::WorkDirectory& work,
                           const Config& config, BuildInput& input, const BuildPlan& build,
                           storage::MemoryPool& pool, const CancelToken& cancel);

}  // namespace meshhier::pipeline
