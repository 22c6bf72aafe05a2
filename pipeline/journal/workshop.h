// The workshop of a build: chunks, forest and their scratch files, with the journal of what is
// done.
#pragma once

#include "execution/cancel.h"
#include "import/mesh_input.h"
#include "pipeline/journal/build_journal.h"
#include "pipeline/journal/restart.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/chunks.h"
#include "pipeline/tiles/forest.h"
#include "storage/format/work_directory.h"
#include "storage/io/spool.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace meshhier::pipeline {

struct Workshop {
  /// Opens the workshop in the directory `work`; throws as BuildJournal. `pool` and all in
  /// `context` must outlive it.
  Workshop(const std::filesystem::path& work, const BuildIdentity& identity,
           const AttributeLayout& layout, storage::MemoryPool& pool, const StageContext& context);

  /// Makes the workshop of a task: its results go to `directory` and its journal's entries to
  /// `sink`; nothing is there yet. `built`: the hierarchy to be.
  Workshop(const std::filesystem::path& directory, const std::filesystem::path& built,
           const BuildIdentity& identity, const AttributeLayout& layout, storage::MemoryPool& pool,
           std::unique_ptr<storage::EntrySink> sink, const StageContext& context);

  storage::ScratchFile mesh_scratch;  ///< needed until the leaves are done
  storage::ScratchFile tile_scratch;
  storage::ScratchFile picture_scratch;  ///< needed until the textures are done
  Chunks chunks;
  Forest forest;
  TextureStore textures;
  images::ImageStore pictures;
  BuildJournal journal;

 private:
  Workshop(const std::filesystem::path& directory, const AttributeLayout& layout,
           storage::MemoryPool& pool, storage::ScratchFile::Files files,
           const StageContext& context,
           const std::function<BuildJournal(const Workpieces&)>& open_journal);
  Workpieces pieces(const StageContext& context);
};

/// Returns all that decides the result of a build, and when its input was changed last.
BuildIdentity identity_of(const config::Config& config, const importing::MeshInput& input,
                          const BuildPlan& plan);

struct OpenWorkshop {
  std::unique_ptr<Workshop> workshop;
  std::string found;  ///< for people: the work done already, or why it was of no use; may be empty
};

/// Opens the work of an earlier build of the same result in `work`, if it can be gone on with; else
/// empties it, but keeps a mesh that was imported. Reads all that was done, to check it, and all of
/// `input` if it was touched since. Throws Error(other_work) as BuildJournal does if `restart` is
/// never, Error(io | interrupted).
OpenWorkshop open_workshop(storage::WorkDirectory& work, importing::MeshInput& input,
                           storage::MemoryPool& pool, Restart restart, const StageContext& context);

/// Returns the description of the input that an earlier build has found.
mesh_io::MeshDescription description_of(const EarlierBuild& build);

/// Returns what reading `input` would find, from an earlier build of the same files; nothing if it
/// had other files or read them in another way. Reads them all if they were touched since.
std::optional<mesh_io::MeshDescription> recall_import(const EarlierBuild& earlier,
                                                      importing::MeshInput& input,
                                                      const config::Config& asked,
                                                      const execution::CancelToken& cancel);

}  // namespace meshhier::pipeline
