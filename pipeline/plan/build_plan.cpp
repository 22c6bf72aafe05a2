#include "pipeline/plan/build_plan.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "config/partition_size.h"
#include "execution/memory_budget.h"
#include "execution/size_text.h"
#include "hierarchy/normal_code.h"
#include "hierarchy/value_channels.h"
#include "images/formats.h"
#include "pipeline/plan/disk_claims.h"
#include "storage/format/layout.h"
#include "storage/format/tile_glb.h"
#include "storage/format/tile_plan.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"

#include <algorithm>

#include <fmt/format.h>
#include <tbb/info.h>

namespace meshhier::pipeline {
namespace {

constexpr std::uint32_t kLargestTile = 32768;  // parent maps and ghost references hold 16 bits

std::uint32_t largest_partition(const Tree& tree) {
  return static_cast<std::uint32_t>((tree.vertex_count() + tree.partition_count() - 1) /
                                    tree.partition_count());
}

/// The disk that a build may take.
struct FreeDisk {
  std::filesystem::path directory;
  std::uint64_t free_bytes = 0;
  std::uint64_t claimed_bytes = 0;  ///< of these by other builds
  std::uint64_t left_bytes = 0;     ///< by an earlier build of the output, besides

  bool has(std::uint64_t bytes) const {
    return free_bytes + left_bytes >= bytes && free_bytes + left_bytes - bytes >= claimed_bytes;
  }
  std::string text() const {
    std::string text =
        fmt::format("{} has {} free", directory.string(), execution::rounded_size_text(free_bytes));
    if (claimed_bytes == 0)
      return text;
    const std::string claimed = execution::rounded_size_text(claimed_bytes);
    return text + (claimed_bytes < free_bytes
                       ? ", of which other builds at work there will take " + claimed
                       : fmt::format(", and other builds at work there will take {}: nothing of "
                                     "it is left for this one",
                                     claimed));
  }
};

FreeDisk find_free_disk(const std::filesystem::path& output, storage::FileSystem& files) {
  const std::filesystem::path directory = storage::existing_directory(files, output);
  return {directory, files.free_bytes(directory), claimed_beside(output, files),
          storage::bytes_at(files, storage::work_path(output))};
}

void add_textures(const config::Config& config, const TexturePlan& textures, JobSize& job) {
  job.textured = textures.is_textured();
  job.pictures = config.picture_format();
  for (const images::Material& material : textures.materials.materials)
    job.alpha = std::max(job.alpha, material.alpha);
  job.picture_side = config.texture.texels;
  job.source_texels = textures.texels();
  job.picture_bytes = textures.stored_bytes();
  job.decoder_bytes = textures.decoder_bytes();
  job.adding_bytes = textures.adding_bytes();
}

std::uint32_t normal_map_side(const config::Config& config, const JobSize& job) {
  const config::Normals normals = config.storage.normals;
  if (job.face_count == 0 || !config::makes_maps(normals))
    return 0;
  if (!job.textured)
    return config.normal_map.texels;
  return normals == config::Normals::map ? job.picture_side : 0;
}

/// With `auto` three levels have none, seven eighths of the simplified tiles: they are nearer to
/// the original's shading themselves.
int unmapped_levels(const config::Config& config) {
  return config.storage.normals == config::Normals::map_or_none ? 3 : 0;
}

TargetVertexCounts target_vertex_counts(const config::Config& config, const Tree& tree,
                                        const TexturePlan& textures) {
  if (config.simplify.vertices)
    return *config.simplify.vertices;
  const bool is_counted = config.partition.count.has_value() || textures.is_textured();
  return is_counted ? std::max(4U, largest_partition(tree)) : config.partition.vertices;
}

}  // namespace

Tree plan_tree(const config::Config& config, std::uint64_t vertex_count,
               const TexturePlan& textures) {
  if (vertex_count == 0) {
    throw Error(ErrorCode::input, fmt::format("{} has no vertices: there is nothing to build",
                                              config.input.string()));
  }
  const std::uint64_t most = config::partition_vertices(config, vertex_count, textures.texels());
  const std::uint64_t count =
      config.partition.count ? *config.partition.count : (vertex_count + most - 1) / most;
  if (count > vertex_count) {
    throw Error(ErrorCode::usage,
                fmt::format("partition.count is {}, but {} has only {}", count,
                            config.input.string(), counted(vertex_count, "vertices")));
  }
  if ((vertex_count + count - 1) / count > kLargestTile) {
    throw Error(ErrorCode::usage,
                fmt::format("partition.count is {}: partitions of {} vertices; a tile holds at "
                            "most {}, so the count "
                            "must be at least {}",
                            count, (vertex_count + count - 1) / count, kLargestTile,
                            (vertex_count + kLargestTile - 1) / kLargestTile));
  }
  return {vertex_count, static_cast<std::uint32_t>(count)};
}

std::size_t thread_count(const config::Config& config) {
  return config.threads > 0 ? config.threads
                            : static_cast<std::size_t>(tbb::info::default_concurrency());
}

std::uint64_t memory_budget(const config::Config& config) {
  // Asked once: plans of one build must agree.
  static const std::uint64_t by_default = execution::default_budget();
  return config.memory_budget.value_or(by_default);
}

JobSize job_size(const config::Config& config, const mesh_io::MeshDescription& mesh,
                 const ImportedBytes& imported, const Tree& tree, const TexturePlan& textures) {
  JobSize job;
  job.vertex_count = mesh.vertex_count;
  job.place_count = tree.vertex_count();
  job.face_count = mesh.face_count;
  job.channels = mesh.attributes.channels();
  job.held_bytes = mesh.held_bytes;
  job.imported_bytes = imported.mesh;
  job.object_table_bytes = imported.objects;
  job.vertices_in_place = mesh.vertices_in_place;
  job.wide_coordinates = mesh.wide_coordinates;
  job.partition_count = tree.partition_count();
  job.threads = thread_count(config);
  job.target_vertex_counts = target_vertex_counts(config, tree, textures);
  job.largest_tile =
      std::max(largest_partition(tree), job.target_vertex_counts.largest_above(tree.depth()));
  job.clustered = config.simplify.method == config::SimplifyMethod::cluster;
  job.computes_normals = config.storage.normals != config::Normals::none &&
                         !mesh.attributes.normals && mesh.face_count > 0 &&
                         !(textures.is_textured() && config.picture_format().unlit);
  job.published_attribute_bytes = storage::published_attribute_bytes(mesh.attributes) +
                                  (job.computes_normals ? sizeof(NormalCode) : 0);
  job.published_ratio = row_of(config.storage.compression).expected_ratio;
  job.draws_preview = config.preview;
  job.outline_sectors = config.outline.sectors;
  job.has_map = config.placement.crs.has_value();
  job.has_objects = placed_object(mesh.attributes).has_value();
  job.has_object_tables = job.has_objects && config.objects.in_tiles;
  job.packed = config.storage.container == storage::Container::archive;
  add_textures(config, textures, job);
  job.normal_map_side = normal_map_side(config, job);
  job.unmapped_levels = unmapped_levels(config);
  job.normal_map_format = config.normal_map.format.format;
  return job;
}

void check_import_disk(std::uint64_t bytes, const std::filesystem::path& output,
                       storage::FileSystem& files) {
  const FreeDisk disk = find_free_disk(output, files);
  if (disk.has(bytes))
    return;
  const std::string need =
      bytes == 0 ? ""
                 : fmt::format("; to import the input takes up to about {} of temporary files",
                               execution::rounded_size_text(bytes));
  throw Error(ErrorCode::budget, disk.text() + need);
}

void check_coders(const JobSize& job) {
  const auto check = [&](const char* key, ImageFormat format, std::uint32_t side) {
    const std::uint32_t most = images::coders_of(format).most_side;
    if (side > most) {
      throw Error(ErrorCode::usage,
                  fmt::format("{}.texels is {}: in {} ({}.format) there are at most {} a side",
                              job.textured ? "texture" : "normal_map", side,
                              row_of(format).file.title, key, most));
    }
  };
  if (job.textured) {
    if (const std::string missing = images::missing_coder(job.pictures); !missing.empty())
      throw Error(ErrorCode::usage, missing);
    check("texture", job.pictures.format, job.picture_side);
  }
  if (job.normal_map_side > 0)
    check("normal_map", job.normal_map_format, job.normal_map_side);
}

void check_disk(const DiskNeed& need, const std::filesystem::path& output,
                storage::FileSystem& files) {
  const FreeDisk disk = find_free_disk(output, files);
  if (!disk.has(need.room_bytes)) {
    throw Error(ErrorCode::budget,
                fmt::format("{}; the hierarchy will take about {} and up to {} of temporary files",
                            disk.text(), execution::rounded_size_text(need.output_bytes),
                            execution::rounded_size_text(need.temporary_bytes)));
  }
}

namespace {

/// Throws if a file of the input would go: with the output that is replaced, or with the work
/// directory.
void require_stay(std::span<const std::filesystem::path> inputs,
                  const std::filesystem::path& output, storage::FileSystem& files) {
  constexpr std::size_t kLongestName = 255;  // longer ones are check_place()'s to tell
  storage::require_apart(files, output, inputs);
  const std::filesystem::path work = storage::work_path(output);
  if (work.filename().native().size() <= kLongestName)
    storage::require_apart(files, work, inputs);
}

}  // namespace

void check_apart(const importing::CompanionFiles& companions, const config::Config& config,
                 const std::vector<std::filesystem::path>& others, storage::FileSystem& files) {
  std::vector<std::filesystem::path> paths;
  for (const importing::CompanionFile& file : companions.files())
    paths.push_back(file.path);
  for (const std::filesystem::path& other : others)
    storage::require_apart(files, other, paths);
  require_stay(paths, config.output, files);
}

void check_apart(const config::Config& config, storage::FileSystem& files) {
  require_stay(config::read_by(config), config.output, files);
}

}  // namespace meshhier::pipeline
