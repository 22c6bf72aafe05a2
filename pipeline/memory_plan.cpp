#include "pipeline/memory_plan.h"

#include <malloc.h>

#include <algorithm>

#include <fmt/format.h>

#include "hierarchy/error.h"
#include "mesh_io/mesh_source.h"
#include "partition/top_tree.h"
#include "pipeline/size_text.h"

namespace meshhier::pipeline {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

// Program, libraries, stacks and allocator slack: 12 to 16 MiB were measured at rest.
constexpr std::uint64_t kBaseBytes = 18 * kMiB;

// Bookkeeping a tile: three blob entries, its record, its statistics.
constexpr std::uint64_t kTileEntryBytes = 320;

// Triangles a vertex: 2 on closed surfaces, less on open ones; half as much again for those that several chunks share.
constexpr std::uint64_t kTrianglesPerVertex = 3;

std::uint64_t vertex_bytes(const JobSize& job) { return 12 + 4 * static_cast<std::uint64_t>(job.channels); }

/// A block of input with its copy, its sorted copy and its ranks.
std::uint64_t block_bytes(const JobSize& job) { return mesh_io::MeshSource::kBlockSize * (2 * vertex_bytes(job) + 32); }

/// The sample, its keys and its positions.
std::uint64_t sample_bytes(const JobSize& job) {
  return std::min(job.vertex_count, partition::kSampleVertices) * (16 + 16 + 12 + 8);
}

/// A chunk read, split and turned into tiles: vertices twice, keys and numbers; triangles as read, as
/// split, as tiles and as bytes.
std::uint64_t chunk_bytes(const JobSize& job) {
  const std::uint64_t vertices = std::min(job.vertex_count, partition::kChunkVertices);
  const std::uint64_t triangles =
      vertices * std::max<std::uint64_t>(kTrianglesPerVertex, job.face_count * 3 / 2 / job.vertex_count + 1);
  return vertices * (3 * vertex_bytes(job) + 60) + triangles * 40;
}

/// Two children read, joined, contracted and encoded: 16 copies of a vertex's 20 bytes and 8 of a triangle's 12.
std::uint64_t tile_bytes(const JobSize& job) {
  const std::uint64_t vertices = 2 * std::uint64_t{job.largest_tile};
  const std::uint64_t triangles =
      vertices * std::max<std::uint64_t>(kTrianglesPerVertex, job.face_count * 3 / 2 / job.vertex_count + 1);
  return vertices * (6 * (vertex_bytes(job) + 8) + 60) + triangles * 60;
}

std::uint64_t bookkeeping_bytes(const JobSize& job) { return 2 * std::uint64_t{job.partition_count} * kTileEntryBytes; }

}  // namespace

MemoryPlan plan_memory(std::uint64_t budget_bytes, const JobSize& job) {
  const std::uint64_t fixed = kBaseBytes + bookkeeping_bytes(job);
  const std::uint64_t least_work =
      std::max({2 * block_bytes(job) + sample_bytes(job), 2 * block_bytes(job) + 12 * kMiB, chunk_bytes(job),
                tile_bytes(job)});
  if (budget_bytes < fixed + least_work) {
    throw Error(ErrorCode::budget,
                fmt::format("memory_budget {} is too small for this mesh; it needs at least {}",
                            exact_size_text(budget_bytes), exact_size_text((fixed + least_work + kMiB - 1) / kMiB * kMiB)));
  }
  const std::uint64_t spare = budget_bytes - fixed - least_work;
  const std::uint64_t threads = job.threads;
  const std::uint64_t wanted_work =
      std::max({least_work, (threads + 1) * chunk_bytes(job), 2 * threads * tile_bytes(job),
                4 * job.vertex_count + 2 * threads * block_bytes(job) + 16 * kMiB});
  MemoryPlan plan;
  plan.work_bytes = std::min(wanted_work, least_work + spare / 2);
  plan.pool_bytes = budget_bytes - fixed - plan.work_bytes;
  plan.blocks_in_flight = std::clamp<std::uint64_t>(plan.work_bytes / 4 / block_bytes(job), 1, 2 * threads);
  plan.chunks_in_flight = std::clamp<std::uint64_t>(plan.work_bytes / chunk_bytes(job), 1, threads + 1);
  plan.tiles_in_flight = std::clamp<std::uint64_t>(plan.work_bytes / tile_bytes(job), 1, 2 * threads);
  const std::uint64_t chunks = job.vertex_count * 2 / partition::kChunkVertices + 1;
  plan.spool_block_bytes = std::clamp<std::uint64_t>(plan.work_bytes / 8 / chunks, 4096, 262144);
  plan.table_bytes = plan.work_bytes - std::min(plan.work_bytes - 4 * kMiB, plan.blocks_in_flight * block_bytes(job) +
                                                                                chunks * plan.spool_block_bytes);
  return plan;
}

DiskNeed predict_disk(const JobSize& job, const MemoryPlan& plan) {
  const std::uint64_t chunk_data =
      job.vertex_count * (vertex_bytes(job) * (job.vertices_in_place ? 1 : 2) + 4) + job.face_count * 12 * 21 / 20;
  const std::uint64_t triangles = job.face_count * 6 * 11 / 10;
  const std::uint64_t tiles = 2 * (job.vertex_count * (vertex_bytes(job) + 10) + triangles);
  const std::uint64_t temporary = std::max(chunk_data + tiles / 2, tiles);
  DiskNeed need;
  need.temporary_bytes = temporary - std::min(temporary, plan.pool_bytes);
  need.output_bytes = 2 * (job.vertex_count * (vertex_bytes(job) + 3) + triangles) + 4096 * std::uint64_t{job.partition_count};
  return need;
}

void configure_allocator() {
  mallopt(M_MMAP_THRESHOLD, 1 << 18);  // larger arrays are mapped alone and leave at once
  mallopt(M_TRIM_THRESHOLD, 1 << 20);
  mallopt(M_ARENA_MAX, 2);
}

void release_free_memory() { malloc_trim(0); }

}  // namespace meshhier::pipeline
