#include "pipeline/leaves_stage.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/allocator.h"
#include "execution/parallel.h"
#include "execution/size_text.h"
#include "partition/chunk.h"
#include "partition/leaf_tiles.h"
#include "partition/top_tree.h"
#include "pipeline/stage_costs.h"
#include "storage/format/work_tile.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

// Each chunk leaves some 3 MiB of free memory behind, between the blobs that stay and where spooled
// blocks were, too small for the tiles that they turn into. Over thousands of chunks that adds up.
constexpr std::size_t kChunksBetweenReleases = 8;

bool fits(std::uint64_t chunk_bytes, const MemoryPlan& plan) {
  return chunk_bytes <= plan.work_bytes + plan.pool_bytes / 2;
}

/// Returns the least budget, in whole MiB, in which a chunk of so many bytes fits.
std::uint64_t budget_for(std::uint64_t chunk_bytes, const StageContext& context) {
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
  const MemoryCosts costs = memory_costs(context.plan.job);
  std::uint64_t below = context.memory().budget_bytes / kMiB;
  std::uint64_t least = below + 1;
  for (; !fits(chunk_bytes, plan_memory(least * kMiB, costs)); least += least - below + 1) {
  }
  while (least - below > 1) {
    const std::uint64_t middle = below + (least - below) / 2;
    (fits(chunk_bytes, plan_memory(middle * kMiB, costs)) ? least : below) = middle;
  }
  return least * kMiB;
}

/// Refuses chunks whose triangles and copies alone exceed what a stage may hold: a place with an
/// absurd number of them.
void check_fit(const Chunks& chunks, const std::vector<std::uint32_t>& all,
               const StageContext& context) {
  const auto bytes_of = [&](std::uint32_t chunk) {
    return (chunks.triangle_bytes(chunk) + chunks.copy_bytes(chunk)) * 4;
  };
  const auto largest = std::ranges::max_element(all, {}, bytes_of);
  if (largest == all.end() || fits(bytes_of(*largest), context.memory()))
    return;
  const std::uint64_t more =
      budget_for(bytes_of(*largest), context) - context.memory().budget_bytes;
  throw Error(
      ErrorCode::budget,
      fmt::format("a part of the mesh has {} on {}; it needs a memory_budget larger by {}",
                  counted(chunks.triangle_count(*largest), "triangles"),
                  counted(chunks.map().size(*largest) + chunks.copy_count(*largest), "vertices"),
                  execution::exact_size_text(more)));
}

struct ChunkReport {
  std::size_t partitions = 0;
  std::uint64_t unreferenced_vertices = 0;
};

/// Splits a chunk and puts its partition tiles.
ChunkReport put_leaves(Chunks& chunks, std::uint32_t index, partition::Axis axis, Forest& forest) {
  const Tree& tree = forest.tree();
  const partition::ChunkMesh chunk = chunks.take(index);
  const std::vector<PartitionId> partition_of = partition::split_chunk(chunk, tree, axis);
  const partition::ChunkLeaves leaves =
      partition::build_leaves(chunk, partition_of, tree, chunks.map());
  forest.put_places(index, leaves.places);
  const std::uint32_t first = tree.partitions(chunk.node).begin;
  for (std::uint32_t p = 0; p < leaves.tiles.size(); ++p)
    forest.put_tile({tree.depth(), first + p}, leaves.tiles[p]);
  return {leaves.tiles.size(), leaves.unreferenced_count};
}

}  // namespace

void check_chunks(const Chunks& chunks, const Share& share, const execution::CancelToken& cancel) {
  for (std::uint64_t i = share.begin(chunks.count()); i < share.end(chunks.count()); ++i) {
    cancel.check();
    const auto chunk = static_cast<std::uint32_t>(i);
    if (const std::optional<Error> change = chunks.find_change(chunk))
      throw *change;
    if (!chunks.is_whole(chunk))
      throw Error(ErrorCode::corrupt, "vertices of a chunk are missing: plan the build again");
  }
}

void make_leaves(Chunks& chunks, Forest& forest, BuildJournal& journal, const Share& share,
                 const StageContext& context) {
  const Tree& tree = context.tree();
  std::vector<std::uint32_t> left;
  std::uint64_t partitions = 0;
  for (std::uint64_t i = share.begin(chunks.count()); i < share.end(chunks.count()); ++i) {
    const auto chunk = static_cast<std::uint32_t>(i);
    if (journal.has_leaves(chunk))
      continue;
    left.push_back(chunk);
    partitions += tree.partitions({chunks.level(), chunk}).size();
  }
  context.progress.stage("leaves", partitions, "partitions");
  check_fit(chunks, left, context);
  execution::ordered_for(
      left.size(), execution::with_those_that_wait(context.memory().chunks_in_flight),
      context.cancel,
      [&](std::size_t i) {
        return put_leaves(chunks, left[i], context.config.partition.axis, forest);
      },
      [&](std::size_t i, const ChunkReport& report) {
        journal.note_leaves(left[i], report.unreferenced_vertices);
        context.progress.advance(report.partitions);
        if (i % kChunksBetweenReleases == kChunksBetweenReleases - 1)
          execution::release_free_memory(context.memory().budget_bytes);
      });
}

StageMemory leaves_memory(const JobSize& job) {
  // A chunk is read, split and turned into tiles: vertices are there twice, with keys and numbers;
  // triangles as read, as split, as tiles and as bytes.
  const std::uint64_t vertices = std::min(job.place_count, partition::kChunkVertices);
  const std::uint64_t triangles = job.part_triangles(vertices);
  const std::uint64_t usual = vertices * (3 * job.vertex_bytes() + 60) + triangles * 40;
  // Where more than two and a half triangles share a vertex, the graph that the chunk is split by
  // counts for more: 500 bytes a vertex at most.
  const bool is_dense = 2 * job.face_count > 5 * job.place_count;
  const std::uint64_t dense = vertices * (job.vertex_bytes() + 500) + triangles * 12;
  // Copies are there twice, with their places and order; the wedges of triangles as read and in
  // tiles.
  const std::uint64_t copies = job.part_copies(vertices) * (2 * job.vertex_bytes() + 24) +
                               std::min(triangles, 6 * job.part_copies(vertices)) * 24;
  const std::uint64_t chunk = (is_dense ? std::max(usual, dense) : usual) + copies;
  return {chunk, job.threads + 1, chunk, (job.threads + 1) * chunk, &MemoryPlan::chunks_in_flight};
}

StageTimes leaves_time(const JobSize& job, const TilePopulation& /*tiles*/) {
  constexpr double kTriangleSeconds = 130e-9;
  return {{"leaves", "partitions", job.partition_count,
           static_cast<double>(job.face_count) * kTriangleSeconds}};
}

DiskVolumes leaves_disk(const JobSize& job, const TilePopulation& tiles,
                        const MemoryPlan& /*memory*/) {
  const double bytes = storage::expected_work_tile_bytes(tiles.partitions, job.vertex_bytes()) +
                       tiles.partitions.boundary * sizeof(partition::LeafPlace);
  return {{bytes, DiskMoment::leaves, DiskMoment::simplify}};
}

}  // namespace meshhier::pipeline
