#include "pipeline/partition_stage.h"

#include "execution/allocator.h"
#include "execution/parallel.h"
#include "execution/size_text.h"
#include "partition/renumber.h"
#include "partition/top_tree.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/plan/tile_room.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using partition::TopPlan;
using partition::TopTree;

constexpr const char* kStage = "partition";

/// Hands the vertices to parallel work(block, slot) and a serial sink(slot) in the order of ids.
template <class Slot, class Work, class Sink>
void for_each_block(const SourceMesh& mesh, const StageContext& context, const Work& work,
                    const Sink& sink) {
  struct Read {
    mesh_io::BlockMemory memory;
    std::size_t count = 0;
    Slot slot;
  };
  execution::ordered_blocks<Read>(
      mesh.vertex_blocks(), context.memory().blocks_in_flight, context.cancel,
      [&](std::uint64_t i, Read& read) {
        const SourceVertices block = mesh.read_vertex_block(i, read.memory);
        read.count = block.positions.size();
        work(block, read.slot);
      },
      [&](Read& read) {
        sink(read.slot);
        context.progress.advance(read.count);
        return true;
      });
}

TopTree find_splits(const SourceMesh& mesh, storage::ScratchFile& scratch,
                    const StageContext& context) {
  const Tree& tree = context.tree();
  TopPlan plan = partition::plan_top(mesh.sample(), tree, context.config.partition.axis);
  if (plan.splits.empty())
    return {plan.chunks, {}};
  for (;;) {
    context.progress.stage(kStage, tree.vertex_count(), "vertices");
    const partition::Sweep sweep(plan);
    partition::TopSelector selector(plan, tree, scratch, context.memory().work_bytes / 2);
    for_each_block<partition::SweepBlock>(
        mesh, context,
        [&](const SourceVertices& block, partition::SweepBlock& swept) {
          sweep.count(block.positions, static_cast<std::uint32_t>(block.first), swept);
        },
        [&](const partition::SweepBlock& swept) { selector.add(swept); });
    std::vector<partition::SplitPlane> planes = selector.settle(plan);
    if (!planes.empty())
      return {plan.chunks, std::move(planes)};
  }
}

/// Distributes the vertices; calls take_ranks(ranks) for block after block: the provisional ranks
/// of the ids in their order.
template <class TakeRanks>
void distribute_vertices(const SourceMesh& mesh, const TopTree& top, Chunks& chunks,
                         const StageContext& context, const TakeRanks& take_ranks) {
  std::vector<std::uint32_t> next_rank(chunks.count());
  for (std::uint32_t c = 0; c < chunks.count(); ++c)
    next_rank[c] = chunks.map().first_rank(c);
  const partition::ChunkSearch search(top, mesh.stored_bounds());
  std::vector<std::uint32_t> ranks;
  for_each_block<ChunkedVertices>(
      mesh, context,
      [&](const SourceVertices& block, ChunkedVertices& sorted) {
        sorted.chunk_of.resize(block.positions.size());
        search.find(block.positions, static_cast<std::uint32_t>(block.first), sorted.chunk_of);
        sorted.sort(chunks.count(), block.positions, block.attributes);
      },
      [&](const ChunkedVertices& sorted) {
        ranks.resize(sorted.chunk_of.size());
        for (std::size_t i = 0; i < ranks.size(); ++i)
          ranks[i] = next_rank[sorted.chunk_of[i]]++;
        take_ranks(std::span<const std::uint32_t>(ranks));
        chunks.append(sorted);
      });
}

/// Distributes the vertices and makes what gives every id its provisional rank: in memory if that
/// is granted.
class RankTable {
 public:
  RankTable(const SourceMesh& mesh, const TopTree& top, Chunks& chunks,
            storage::ScratchFile& scratch, const StageContext& context)
      : scratch_(scratch), spooled_(scratch, 1 << 18) {
    const std::uint64_t count = mesh.summary().vertices;
    renumbering_ =
        partition::plan_renumbering(count, sizeof(std::uint32_t), context.memory().table_bytes);
    context.progress.stage(kStage, count, "vertices");
    const bool in_memory = renumbering_.blocks == 1;
    if (in_memory)
      table_.reserve(count);
    distribute_vertices(mesh, top, chunks, context, [&](auto ranks) {
      in_memory ? void(table_.insert(table_.end(), ranks.begin(), ranks.end()))
                : spooled_.append(ranks);
    });
  }

  /// Call once.
  partition::Renumberer<std::uint32_t> renumberer() {
    if (renumbering_.blocks == 1)
      return {std::move(table_), scratch_};
    return {spooled_, renumbering_, scratch_};
  }

 private:
  storage::ScratchFile& scratch_;
  partition::RenumberPlan renumbering_;
  std::vector<std::uint32_t> table_;
  storage::RecordSpool<std::uint32_t> spooled_;
};

mesh_io::FaceCounts distribute_triangles(SourceMesh& mesh, RankTable& ranks, Chunks& chunks,
                                         const StageContext& context) {
  struct Slot {
    std::size_t read = 0;
    partition::Renumbered<std::uint32_t> renumbered;
    ChunkedTriangles chunked;
  };
  const std::size_t in_flight = context.memory().blocks_in_flight;
  context.progress.stage(kStage, mesh.declared_faces(), "triangles");
  partition::Renumberer<std::uint32_t> renumberer = ranks.renumberer();
  const auto keep = [&](const Slot& slot) {
    renumberer.keep(slot.renumbered);
    chunks.append(slot.chunked);
    return true;
  };
  const mesh_io::FaceCounts counts = mesh.read_triangles<Slot>(
      in_flight, context.cancel,
      [&](std::span<const Triangle<VertexId>> triangles, Slot& slot) {
        slot.read = triangles.size();
        renumberer.translate(triangles, slot.renumbered);
        slot.chunked.sort(slot.renumbered.finished, chunks.map());
      },
      [&](const Slot& slot) {
        keep(slot);
        context.progress.advance(slot.read);
      });
  while (renumberer.next_round()) {
    execution::ordered_blocks<Slot>(
        renumberer.batches(), in_flight, context.cancel,
        [&](std::uint64_t batch, Slot& slot) {
          renumberer.translate_batch(batch, slot.renumbered);
          slot.chunked.sort(slot.renumbered.finished, chunks.map());
        },
        keep);
  }
  return counts;
}

/// The stage that would be refused comes late, and takes long where triangles reach across.
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

}  // namespace

mesh_io::FaceCounts partition_mesh(SourceMesh& mesh, Chunks& chunks, storage::ScratchFile& scratch,
                                   const StageContext& context) {
  const TopTree top = [&] {
    storage::ScratchFile windows = scratch.beside("windows");
    return find_splits(mesh, windows, context);
  }();
  execution::release_free_memory();
  storage::ScratchFile passing = scratch.beside("ranks");
  RankTable ranks(mesh, top, chunks, passing, context);
  execution::release_free_memory();
  const mesh_io::FaceCounts counts = distribute_triangles(mesh, ranks, chunks, context);
  warn_of_wide_triangles(chunks, context);
  execution::release_free_memory();
  return counts;
}

StageMemory partition_memory(const JobSize& job) {
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
  constexpr std::uint64_t kNodeBytes = 1024;  // a split, and the spool of its window
  const std::uint64_t block = input_block_bytes(job);
  const auto spools = ChunkSpools::of(job.vertex_count, job.vertex_bytes(), job.face_count);
  const std::uint64_t splits =
      2 * block + sample_bytes(job) + most_chunks(job.vertex_count) * kNodeBytes;
  const std::uint64_t distribution = 2 * block + 12 * kMiB + spools.bytes(ChunkSpools::kLeastBlock);
  // With so much the table of ranks is in memory as a whole, beside the spools of chunks.
  const std::uint64_t beside =
      2 * job.threads * block + spools.index_bytes(4 * ChunkSpools::kLeastBlock);
  const std::uint64_t table = (sizeof(std::uint32_t) * job.vertex_count + beside) /
                                  (ChunkSpools::kWorkParts - 1) * ChunkSpools::kWorkParts +
                              4 * kMiB;
  return {block, 2 * job.threads, std::max(splits, distribution), table};
}

std::vector<StageTime> partition_time(const JobSize& job) {
  constexpr double kVertexSeconds = 35e-9;
  constexpr double kTriangleSeconds = 35e-9;
  const StageTime vertices{kStage, "vertices", job.vertex_count,
                           static_cast<double>(job.vertex_count) * kVertexSeconds};
  return {vertices,
          vertices,
          {kStage, "triangles", job.face_count,
           static_cast<double>(job.face_count) * kTriangleSeconds}};
}

DiskVolumes partition_disk(const JobSize& job, const MemoryPlan& memory) {
  const auto vertices = static_cast<double>(job.vertex_count);
  const partition::RenumberPlan renumbering =
      partition::plan_renumbering(job.vertex_count, sizeof(std::uint32_t), memory.table_bytes);
  const double waiting =
      partition::expected_waiting_bytes<std::uint32_t>(renumbering, job.face_count);
  const double chunks =
      vertices * job.vertex_bytes() +
      Chunks::expected_triangle_bytes(job.vertex_count, job.face_count, kBoundaryShare);
  using enum DiskMoment;
  return {{partition::expected_window_bytes(job.vertex_count), splits, splits, true},
          {vertices * sizeof(std::uint32_t), triangles, triangles, true},
          {waiting, triangles, triangles, true},
          {chunks, triangles, triangles, true},
          {chunks, noted, leaves}};
}

}  // namespace meshhier::pipeline
