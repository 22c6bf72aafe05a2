#include "pipeline/plan/memory_plan.h"

#include "execution/size_text.h"
#include "hierarchy/error.h"
#include "mesh_io/mesh_source.h"
#include "partition/top_tree.h"
#include "pipeline/tiles/chunks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

// Program, libraries, stacks and allocator slack: 12 to 16 MiB were measured at rest.
constexpr std::uint64_t kBaseBytes = 18 * kMiB;

// Of the budget, what the allocator keeps of memory that was given back.
constexpr std::uint64_t kAllocatorParts = 12;

// Bookkeeping a tile: four blob entries, what is known of it, its record, its statistics, its step
// and the sums of steps with some twenty neighbours each.
constexpr std::uint64_t kTileEntryBytes = 480;

// A file's place in the index of an archive, twice while the list grows.
constexpr std::uint64_t kPackedFileBytes = 48;

// Triangles a vertex: 2 on closed surfaces, less on open ones; half as much again for those that
// several chunks share.
constexpr std::uint64_t kTrianglesPerVertex = 3;

/// A block of input with its copy, its sorted copy and its ranks.
std::uint64_t block_bytes(const JobSize& job) {
  return mesh_io::MeshSource::kBlockSize * (2 * job.vertex_bytes() + 32);
}

/// The sample, its keys and its positions.
std::uint64_t sample_bytes(const JobSize& job) {
  return std::min(job.vertex_count, partition::kSampleVertices) * (16 + 16 + 12 + 8);
}

/// A chunk read, split and turned into tiles: vertices twice, keys and numbers; triangles as read,
/// as split, as tiles and as bytes. Where more than two and a half triangles share a vertex, the
/// graph that the chunk is split by counts for more: 500 bytes a vertex at most.
std::uint64_t chunk_bytes(const JobSize& job) {
  const std::uint64_t vertices = std::min(job.vertex_count, partition::kChunkVertices);
  const std::uint64_t triangles =
      vertices *
      std::max<std::uint64_t>(kTrianglesPerVertex, job.face_count * 3 / 2 / job.vertex_count + 1);
  const std::uint64_t usual = vertices * (3 * job.vertex_bytes() + 60) + triangles * 40;
  const bool is_dense = 2 * job.face_count > 5 * job.vertex_count;
  return is_dense ? std::max(usual, vertices * (job.vertex_bytes() + 500) + triangles * 12) : usual;
}

/// Two children read, joined, contracted and encoded: 16 copies of a vertex's 20 bytes and 8 of a
/// triangle's 12; edges, queue and quadrics while they collapse.
std::uint64_t tile_bytes(const JobSize& job) {
  const std::uint64_t vertices = std::min(2 * std::uint64_t{job.largest_tile}, job.vertex_count);
  const std::uint64_t triangles =
      vertices *
      std::max<std::uint64_t>(kTrianglesPerVertex, job.face_count * 3 / 2 / job.vertex_count + 1);
  return vertices * (6 * (job.vertex_bytes() + 8) + 260) + triangles * 80;
}

/// No more chunks than this: each has more than half of kChunkVertices.
std::uint64_t chunk_count(const JobSize& job) {
  return job.vertex_count * 2 / partition::kChunkVertices + 1;
}

// A spool's block: open ones weigh against the index of all, and both are least together at about 4
// KiB, whatever the size of the mesh.
constexpr std::uint64_t kLeastSpoolBlock = 4096;
constexpr std::uint64_t kMostSpoolBlock = 262144;

/// The index of the spools of chunks: 8 bytes for every block there is, in vectors that may be half
/// empty, and both halves held while they grow.
std::uint64_t spool_index_bytes(const JobSize& job, std::uint64_t block) {
  const std::uint64_t spooled = job.vertex_count * job.vertex_bytes() + job.face_count * 13;
  return spooled / block * 24;
}

/// What the spools of chunks hold while they are written: the open blocks, and their index.
std::uint64_t spool_bytes(const JobSize& job, std::uint64_t block) {
  return Chunks::kSpools * chunk_count(job) * block + spool_index_bytes(job, block);
}

/// With so much the table of ranks is in memory as a whole while the triangles are distributed,
/// beside the spools of chunks, whose open blocks have an eighth.
std::uint64_t table_work_bytes(const JobSize& job) {
  const std::uint64_t beside =
      2 * job.threads * block_bytes(job) + spool_index_bytes(job, 4 * kLeastSpoolBlock);
  return (4 * job.vertex_count + beside) / 7 * 8 + 4 * kMiB;
}

std::uint64_t bookkeeping_bytes(const JobSize& job) {
  return 2 * std::uint64_t{job.partition_count} *
         (kTileEntryBytes + (job.packed ? kPackedFileBytes : 0));
}

/// What is held all the time.
std::uint64_t fixed_bytes(const JobSize& job) {
  return kBaseBytes + bookkeeping_bytes(job);
}

/// What the hungriest stage holds with one item in flight.
std::uint64_t least_work_bytes(const JobSize& job) {
  return std::max({2 * block_bytes(job) + sample_bytes(job) + chunk_count(job) * 1024,
                   2 * block_bytes(job) + 12 * kMiB + spool_bytes(job, kLeastSpoolBlock),
                   chunk_bytes(job), tile_bytes(job)});
}

}  // namespace

std::uint64_t least_budget(const JobSize& job) {
  return (fixed_bytes(job) + least_work_bytes(job) + kMiB - 1) / kMiB * kMiB;
}

MemoryPlan plan_memory(std::uint64_t budget_bytes, const JobSize& job) {
  const std::uint64_t fixed = fixed_bytes(job);
  const std::uint64_t least_work = least_work_bytes(job);
  if (budget_bytes < fixed + least_work) {
    throw Error(ErrorCode::budget,
                fmt::format("memory_budget {} is too small for this mesh; it needs at least {}",
                            execution::exact_size_text(budget_bytes),
                            execution::exact_size_text(least_budget(job))));
  }
  const std::uint64_t spare = budget_bytes - fixed - least_work;
  const std::uint64_t threads = job.threads;
  const std::uint64_t wanted_work =
      std::max({least_work, (threads + 1) * chunk_bytes(job), 2 * threads * tile_bytes(job),
                table_work_bytes(job)});
  MemoryPlan plan;
  plan.budget_bytes = budget_bytes;
  plan.work_bytes = std::min(wanted_work, least_work + spare / 2);
  const std::uint64_t rest = budget_bytes - fixed - plan.work_bytes;
  plan.pool_bytes = rest - std::min(rest, budget_bytes / kAllocatorParts);
  plan.blocks_in_flight =
      std::clamp<std::uint64_t>(plan.work_bytes / 4 / block_bytes(job), 1, 2 * threads);
  plan.chunks_in_flight =
      std::clamp<std::uint64_t>(plan.work_bytes / chunk_bytes(job), 1, threads + 1);
  plan.tiles_in_flight =
      std::clamp<std::uint64_t>(plan.work_bytes / tile_bytes(job), 1, 2 * threads);
  const std::uint64_t spools = Chunks::kSpools * chunk_count(job);
  plan.spool_block_bytes =
      std::clamp(plan.work_bytes / 8 / spools, kLeastSpoolBlock, kMostSpoolBlock);
  plan.table_bytes = plan.work_bytes - std::min(plan.work_bytes - 4 * kMiB,
                                                plan.blocks_in_flight * block_bytes(job) +
                                                    spool_bytes(job, plan.spool_block_bytes));
  return plan;
}

}  // namespace meshhier::pipeline
