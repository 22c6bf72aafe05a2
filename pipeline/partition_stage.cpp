#include "pipeline/partition_stage.h"

#include "execution/allocator.h"
#include "execution/size_text.h"
#include "execution/spool_cursor.h"
#include "partition/rank_table.h"
#include "partition/top_tree.h"
#include "pipeline/distribution.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/plan/tile_room.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using partition::RankTable;
using partition::Renumberer;
using partition::TopPlan;
using partition::TopTree;
using partition::WedgeRank;

/// Distributes the first vertices of all places and fills the table of ranks. Copies wait in
/// `copy_rows` until their places' ranks are known.
template <class Rank>
void fill_table(const SourceMesh& mesh, const importing::CopyList& copies, const TopTree& top,
                Chunks& chunks, RankTable<Rank>& table, storage::RecordSpool<float>& copy_rows,
                const StageContext& context) {
  const auto keep = [&](const std::vector<Rank>& ranks, const DistributedBlock& block) {
    if (!table.is_in_memory())
      table.append(ranks, block.first, block.places.copies);
    copy_rows.append(std::span<const float>(block.copy_rows));
  };
  const auto put = [&](const std::vector<Rank>& ranks, const DistributedBlock& block) {
    if (table.is_in_memory())
      table.put(ranks, block.first, block.places.copies);
  };
  distribute_places<Rank>(mesh, copies, top, {}, chunks, keep, put, context);
}

/// Gives copies the ranks of their places, and their rows to the chunks.
void distribute_copies(const importing::CopyList& copies,
                       const storage::RecordSpool<float>& copy_rows, std::size_t row_width,
                       Chunks& chunks, RankTable<WedgeRank>& table, const StageContext& context) {
  execution::SpoolCursor values(copy_rows, context.cancel);
  std::vector<float> row(row_width);
  std::uint64_t next = 0;
  const auto check = [&] { context.cancel.check(); };
  table.settle([&](const auto& visit) { copies.for_each(check, visit); },
               [&](std::uint32_t rank) {
                 for (float& value : row)
                   value = values.at(next++);
                 chunks.append_copy(rank, row);
               });
}

template <class Slot, class Rank>
mesh_io::FaceCounts distribute_faces(SourceMesh& mesh, Renumberer<Rank> renumberer, Chunks& chunks,
                                     const StageContext& context) {
  context.progress.stage(kPartitionStage, mesh.declared_faces(), "triangles");
  TriangleDistribution<Slot, Rank> triangles(mesh, std::move(renumberer), chunks, context);
  const mesh_io::FaceCounts blocks = triangles.take_blocks({}).counts;
  const mesh_io::FaceCounts rest = triangles.take_from(blocks.faces);
  triangles.finish();
  return blocks + rest;
}

/// Distributes vertices, then triangles. `passing`: scratch for data that is needed only meanwhile.
mesh_io::FaceCounts distribute(SourceMesh& mesh, const importing::CopyList& copies,
                               const TopTree& top, Chunks& chunks, storage::ScratchFile& passing,
                               const StageContext& context) {
  const std::uint64_t count = mesh.summary().vertices;
  context.progress.stage(kPartitionStage, count, "vertices");
  const auto triangles = [&]<class Slot>(auto& table, Slot) {
    execution::release_free_memory(context.memory().budget_bytes);
    return distribute_faces<Slot>(mesh, table.renumberer(), chunks, context);
  };
  storage::RecordSpool<float> copy_rows(passing, 1 << 18);
  if (copies.empty()) {
    RankTable<std::uint32_t> table(count, context.memory().table_bytes, passing);
    fill_table(mesh, copies, top, chunks, table, copy_rows, context);
    return triangles(table, TrianglesByRank{});
  }
  RankTable<WedgeRank> table(count, context.memory().table_bytes, passing);
  fill_table(mesh, copies, top, chunks, table, copy_rows, context);
  distribute_copies(copies, copy_rows, chunks.row_width(), chunks, table, context);
  copy_rows.clear();
  return triangles(table, TrianglesByWedge{});
}

}  // namespace

TopTree find_splits(SourceMesh& mesh, const importing::CopyList& copies,
                    storage::ScratchFile& scratch, const StageContext& context) {
  storage::ScratchFile windows = scratch.beside("windows");
  const Tree& tree = context.tree();
  TopPlan plan = partition::plan_top(mesh.take_sample(copies), tree, context.config.partition.axis);
  if (plan.splits.empty())
    return {plan.chunks, {}};
  for (;;) {
    context.progress.stage(kPartitionStage, mesh.summary().vertices, "vertices");
    const partition::Sweep sweep(plan);
    partition::TopSelector selector(plan, tree, windows, context.memory().work_bytes / 2);
    struct Slot {
      BlockPlaces places;
      partition::SweepBlock swept;
    };
    for_each_block<Slot>(
        mesh, {}, context,
        [&](const SourceVertices& block, Slot& slot) {
          if (slot.places.pick(block, copies))
            sweep.count(slot.places.positions, slot.places.ids, slot.swept);
          else
            sweep.count(block.positions, static_cast<std::uint32_t>(block.first), slot.swept);
        },
        [](const Slot&) {}, [&](const Slot& slot) { selector.add(slot.swept); });
    std::vector<partition::SplitPlane> planes = selector.settle(plan);
    if (!planes.empty())
      return {plan.chunks, std::move(planes)};
  }
}

mesh_io::FaceCounts partition_mesh(SourceMesh& mesh, const importing::CopyList& copies,
                                   Chunks& chunks, storage::ScratchFile& scratch,
                                   const StageContext& context) {
  const TopTree top = find_splits(mesh, copies, scratch, context);
  execution::release_free_memory(context.memory().budget_bytes);
  storage::ScratchFile passing = scratch.beside("ranks");
  const mesh_io::FaceCounts counts = distribute(mesh, copies, top, chunks, passing, context);
  warn_of_wide_triangles(chunks, context);
  execution::release_free_memory(context.memory().budget_bytes);
  return counts;
}

void warn_of_wide_triangles(const Chunks& chunks, const StageContext& context) {
  const MemoryPlan& plan = context.memory();
  const std::uint64_t expected = expected_contracted(chunks);
  if (expected <= plan.work_bytes + plan.pool_bytes)
    return;
  context.progress.warn(fmt::format(
      "many triangles of the mesh reach far across it: a tile may take {} or more, and "
      "memory_budget {} leaves less. The build goes on and may be refused later; it will probably "
      "need more than {}",
      execution::rounded_size_text(expected), execution::exact_size_text(plan.budget_bytes),
      execution::rounded_size_text(budget_for(plan, expected))));
}

namespace {

/// Returns the bytes of an entry of the table of ranks.
std::uint64_t rank_bytes(const JobSize& job) {
  return job.has_copies() ? sizeof(WedgeRank) : sizeof(std::uint32_t);
}

}  // namespace

ChunkSpools chunk_spools(const JobSize& job) {
  return ChunkSpools::of(job.place_count, job.vertex_count - job.place_count, job.vertex_bytes(),
                         job.face_count, job.wedged_triangles());
}

StageMemory partition_memory(const JobSize& job) {
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
  constexpr std::uint64_t kNodeBytes = 1024;  // a split, and the spool of its window
  const std::uint64_t block = input_block_bytes(job);
  const ChunkSpools spools = chunk_spools(job);
  const std::uint64_t splits =
      2 * block + sample_bytes(job) + most_chunks(job.place_count) * kNodeBytes;
  const std::uint64_t distribution = 2 * block + 12 * kMiB + spools.bytes(ChunkSpools::kLeastBlock);
  // So much lets the whole table of ranks be in memory, beside the spools of chunks.
  const std::uint64_t beside =
      2 * job.threads * block + spools.index_bytes(4 * ChunkSpools::kLeastBlock);
  const std::uint64_t table = (rank_bytes(job) * job.vertex_count + beside) /
                                  (ChunkSpools::kWorkParts - 1) * ChunkSpools::kWorkParts +
                              4 * kMiB;
  constexpr std::uint64_t kBlockParts = 4;
  return {block,
          2 * job.threads,
          std::max(splits, distribution),
          table,
          &MemoryPlan::blocks_in_flight,
          kBlockParts};
}

StageTimes partition_time(const JobSize& job, const TilePopulation& /*tiles*/) {
  constexpr double kVertexSeconds = 35e-9;
  constexpr double kTriangleSeconds = 35e-9;
  const StageTime vertices{kPartitionStage, "vertices", job.vertex_count,
                           static_cast<double>(job.vertex_count) * kVertexSeconds};
  return {vertices,
          vertices,
          {kPartitionStage, "triangles", job.face_count,
           static_cast<double>(job.face_count) * kTriangleSeconds}};
}

DiskVolumes partition_disk(const JobSize& job, const TilePopulation& /*tiles*/,
                           const MemoryPlan& memory) {
  const auto vertices = static_cast<double>(job.vertex_count);
  const partition::RenumberPlan renumbering =
      partition::plan_renumbering(job.vertex_count, rank_bytes(job), memory.table_bytes);
  const double waiting =
      job.has_copies()
          ? partition::expected_waiting_bytes<WedgeRank>(renumbering, job.face_count)
          : partition::expected_waiting_bytes<std::uint32_t>(renumbering, job.face_count);
  const double chunks = vertices * job.vertex_bytes() +
                        Chunks::expected_triangle_bytes(job.place_count, job.face_count,
                                                        job.wedged_triangles(), kBoundaryShare);
  // Copies have a list, and rows until the ranks of their places are known; then these ranks.
  const auto copies = static_cast<double>(job.vertex_count - job.place_count);
  const double list = copies * sizeof(CopyVertex);
  const double rows = copies * job.vertex_bytes();
  const double ranks = vertices * static_cast<double>(rank_bytes(job));
  using enum DiskMoment;
  return {
      {partition::expected_window_bytes(job.place_count), splits, splits, true},
      {list, splits, triangles, true},
      {ranks + std::max(rows, copies * sizeof(partition::RankedCopy)), triangles, triangles, true},
      {waiting, triangles, triangles, true},
      {chunks + copies * sizeof(float), triangles, triangles, true},
      {chunks + copies * sizeof(float), noted, leaves}};
}

}  // namespace meshhier::pipeline
