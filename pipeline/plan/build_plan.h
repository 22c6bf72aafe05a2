// The plan of a build, made before anything is written: the tree, the division of memory, the need
// of disk.
#pragma once

#include "config/config.h"
#include "hierarchy/target_vertex_counts.h"
#include "hierarchy/tree.h"
#include "import/input_record.h"
#include "mesh_io/mesh_source.h"
#include "pipeline/plan/disk_need.h"
#include "pipeline/plan/job_size.h"
#include "pipeline/plan/memory_plan.h"
#include "pipeline/plan/texture_plan.h"
#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace meshhier::pipeline {

struct BuildPlan {
  Tree tree;
  std::size_t threads = 1;
  TargetVertexCounts target_vertex_counts{};  ///< for simplified tiles
  JobSize job{};
  MemoryPlan memory{};
  DiskNeed disk{};
  TexturePlan textures{};
};

/// Returns the tree over the partitions of a mesh. Throws Error(usage | input) if those asked for
/// cannot be.
Tree plan_tree(const config::Config& config, std::uint64_t vertex_count,
               const TexturePlan& textures = {});

/// The bytes of what the import has left; 0 of what it has not.
struct ImportedBytes {
  std::uint64_t mesh = 0;     ///< the PLY
  std::uint64_t objects = 0;  ///< their table
};

/// Returns the size of the job for a mesh of which the header was read.
JobSize job_size(const config::Config& config, const mesh_io::MeshDescription& mesh,
                 const ImportedBytes& imported, const Tree& tree, const TexturePlan& textures = {});

/// Returns the number of threads that a build of that config uses.
std::size_t thread_count(const config::Config& config);

/// Returns the bytes of memory that it may use: execution::default_budget() if the config does not
/// say.
std::uint64_t memory_budget(const config::Config& config);

/// Throws Error(usage) if a file of the input lies where the output will be: a replaced output is
/// removed, and the input must not go with it.
void check_apart(const config::Config& config, storage::FileSystem& files);

/// Does the same for the files that meshes name, which are known when the meshes are read.
/// `others`: files that are written besides the output.
void check_apart(const importing::CompanionFiles& companions, const config::Config& config,
                 const std::vector<std::filesystem::path>& others, storage::FileSystem& files);

/// Throws Error(budget) if the disk that will hold `output` has less than `bytes` for an import,
/// beside what others claim (disk_claims.h).
void check_import_disk(std::uint64_t bytes, const std::filesystem::path& output,
                       storage::FileSystem& files);

/// Throws Error(usage) if pictures are to be stored as this machine cannot, with what to install,
/// or larger than the format allows.
void check_coders(const JobSize& job);

/// Throws Error(budget) if the disk that will hold `output` has too little room, beside what others
/// claim.
void check_disk(const DiskNeed& need, const std::filesystem::path& output,
                storage::FileSystem& files);

}  // namespace meshhier::pipeline
