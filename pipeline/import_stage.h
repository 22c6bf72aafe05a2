// The stage `import`: input that cannot be read where it lies becomes one PLY in the work
// directory, and vertices that lie at one place are found.
#pragma once

#include "import/mesh_input.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/plan/tile_population.h"
#include "storage/format/work_directory.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace meshhier::pipeline {

/// Opens the meshes of a config as a build of it reads them. Throws as MeshInput.
importing::MeshInput open_input(const config::Config& config, storage::FileSystem& files);

/// Returns how the budget is divided while the stage runs.
importing::ImportMemory import_memory(const importing::MeshInput& input,
                                      const config::Config& config);

/// Returns the bytes of what the import has left.
ImportedBytes imported_by(const importing::MeshInput& input);

/// Returns about how many bytes the stage has in temporary files at most, before it is known what
/// is in the input.
std::uint64_t import_disk(const importing::MeshInput& input, const config::Config& config);

/// The disk that stays taken: the PLY, until the triangles are distributed.
DiskVolumes imported_disk(const JobSize& job, const TilePopulation& tiles,
                          const MemoryPlan& memory);

/// Returns the times of the import and of all that follows, from the files' sizes alone.
std::vector<StageTime> import_time(const importing::MeshInput& input, const config::Config& config);

/// Whether the input must be read before the build can be planned: it is to be imported, or places
/// are to be found.
bool is_read_before_plan(const importing::MeshInput& input, const config::Config& config);

/// Imports what needs it, and finds places if topology is by place.
void read_once(importing::MeshInput& input, const config::Config& config,
               const importing::MeshInput::Place& place);

/// Imports the input and finds places in `directory`, then plans the build. `objects`: becomes the
/// table of objects, if there are any. Throws as importing::import_input, importing::find_copies
/// and plan_build.
BuildPlan read_and_plan(importing::MeshInput& input, const std::filesystem::path& directory,
                        const std::filesystem::path& objects, storage::MemoryPool& pool,
                        const config::Config& config, const BuildEnvironment& environment);

/// Does the same and checks the disk, unless an earlier build did whose work is still there. Keeps
/// the work directory if there is earlier work. Throws also as check_disk.
BuildPlan import_and_plan(importing::MeshInput& input, storage::WorkDirectory& work,
                          storage::MemoryPool& pool, const config::Config& config,
                          const BuildEnvironment& environment);

/// Whether enough of the input was read for the stages from `ingest` on.
bool can_be_read(const importing::MeshInput& input, const config::Config& config);

/// Imports the input although an earlier build did, because its work is of no use. Throws
/// Error(input) if the input is not what it was.
void import_again(importing::MeshInput& input, const storage::WorkDirectory& work,
                  storage::MemoryPool& pool, const StageContext& context);

}  // namespace meshhier::pipeline
