#include "pipeline/partition_stage.h"

#include "execution/allocator.h"
#include "execution/parallel.h"
#include "execution/size_text.h"
#include "execution/spool_cursor.h"
#include "hierarchy/error.h"
#include "partition/rank_table.h"
#include "partition/top_tree.h"
#include "pipeline/plan/tile_population.h"
#include "pipeline/plan/tile_room.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using partition::RankTable;
using partition::Renumberer;
using partition::RenumberTable;
using partition::TopPlan;
using partition::TopTree;
using partition::WedgeRank;

constexpr const char* kStage = "partition";

/// Hands a share of the vertices to parallel work(block, slot) and a serial sink(slot) in the order
/// of ids.
template <class Slot, class Work, class Sink>
void for_each_block(const SourceMesh& mesh, const Share& share, const StageContext& context,
                    const Work& work, const Sink& sink) {
  struct Read {
    mesh_io::BlockMemory memory;
    std::size_t count = 0;
    Slot slot;
  };
  const std::uint64_t first = share.begin(mesh.vertex_blocks());
  execution::ordered_blocks<Read>(
      share.end(mesh.vertex_blocks()) - first, context.memory().blocks_in_flight, context.cancel,
      [&](std::uint64_t i, Read& read) {
        const SourceVertices block = mesh.read_vertex_block(first + i, read.memory);
        read.count = block.positions.size();
        work(block, read.slot);
      },
      [&](Read& read) {
        sink(read.slot);
        context.progress.advance(read.count);
        return true;
      });
}

/// The first vertices of the places in a block, and the copies among its vertices.
struct BlockPlaces {
  std::vector<Vec3f> positions;
  std::vector<float> attributes;
  std::vector<std::uint32_t> ids;
  std::vector<CopyVertex> memory;
  std::span<const CopyVertex> copies;

  /// False, and nothing picked, if all vertices of the block are.
  bool pick(const SourceVertices& block, const importing::CopyList& list) {
    copies = list.read(block.first, block.positions.size(), memory);
    if (copies.empty())
      return false;
    const std::size_t channels = block.channels();
    positions.clear();
    attributes.clear();
    ids.clear();
    auto copy = copies.begin();
    for (std::size_t i = 0; i < block.positions.size(); ++i) {
      const auto id = static_cast<std::uint32_t>(block.first + i);
      if (copy != copies.end() && copy->id == id) {
        ++copy;
        continue;
      }
      positions.push_back(block.positions[i]);
      const auto values = block.attributes.subspan(i * channels, channels);
      attributes.insert(attributes.end(), values.begin(), values.end());
      ids.push_back(id);
    }
    return true;
  }
};

/// A block of vertices on its way to the chunks.
struct DistributedBlock {
  ChunkedVertices sorted;  ///< the places' first vertices
  // With copies only:
  std::uint64_t first = 0;  ///< id
  BlockPlaces places;
  std::vector<float> copy_rows;

  void sort(const SourceVertices& block, const importing::CopyList& list,
            const partition::ChunkSearch& search, std::uint32_t chunk_count) {
    first = block.first;
    copy_rows.clear();
    if (!places.pick(block, list)) {
      sorted.chunk_of.resize(block.positions.size());
      search.find(block.positions, static_cast<std::uint32_t>(block.first), sorted.chunk_of);
      sorted.sort(chunk_count, block.positions, block.attributes);
      return;
    }
    sorted.chunk_of.resize(places.positions.size());
    search.find(places.positions, places.ids, sorted.chunk_of);
    sorted.sort(chunk_count, places.positions, places.attributes);
    take_copies(block);
  }

 private:
  void take_copies(const SourceVertices& block) {
    const std::size_t channels = block.channels();
    for (const CopyVertex& copy : places.copies) {
      const std::size_t at = copy.id - block.first;
      const Vec3f& p = block.positions[at];
      copy_rows.insert(copy_rows.end(), {p.x, p.y, p.z});
      const auto values = block.attributes.subspan(at * channels, channels);
      copy_rows.insert(copy_rows.end(), values.begin(), values.end());
    }
  }
};

/// Gives the places' first vertices of a block their ranks.
class Ranker {
 public:
  explicit Ranker(const Chunks& chunks) : next_(chunks.count()) {
    for (std::uint32_t c = 0; c < chunks.count(); ++c)
      next_[c] = chunks.map().first_rank(c);
  }

  template <class Rank>
  void rank(const ChunkedVertices& block, std::vector<Rank>& ranks) {
    ranks.clear();
    for (const std::uint32_t chunk : block.chunk_of)
      ranks.push_back(Rank{next_[chunk]++});
  }

 private:
  std::vector<std::uint32_t> next_;
};

/// Distributes the places' first vertices of a share; keep(ranks, block) gets their ranks.
template <class Rank, class Keep>
void distribute_places(const SourceMesh& mesh, const importing::CopyList& copies,
                       const TopTree& top, const Share& share, Chunks& chunks, const Keep& keep,
                       const StageContext& context) {
  const partition::ChunkSearch search(top, mesh.stored_bounds());
  Ranker ranker(chunks);
  std::vector<Rank> ranks;
  for_each_block<DistributedBlock>(
      mesh, share, context,
      [&](const SourceVertices& block, DistributedBlock& distributed) {
        distributed.sort(block, copies, search, chunks.count());
      },
      [&](const DistributedBlock& distributed) {
        ranker.rank(distributed.sorted, ranks);
        keep(ranks, distributed);
        chunks.append(distributed.sorted);
      });
}

/// Distributes them all and fills the table of ranks. Copies wait in `copy_rows` until their
/// places' ranks are known.
template <class Rank>
void fill_table(const SourceMesh& mesh, const importing::CopyList& copies, const TopTree& top,
                Chunks& chunks, RankTable<Rank>& table, storage::RecordSpool<float>& copy_rows,
                const StageContext& context) {
  const auto keep = [&](const std::vector<Rank>& ranks, const DistributedBlock& block) {
    table.append(ranks, block.first, block.places.copies);
    copy_rows.append(std::span<const float>(block.copy_rows));
  };
  distribute_places<Rank>(mesh, copies, top, {}, chunks, keep, context);
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

/// A block of triangles on its way to the chunks.
struct TrianglesByRank {
  std::size_t read = 0;
  partition::Renumbered<std::uint32_t> renumbered;
  ChunkedTriangles chunked;

  void sort(const partition::ChunkMap& map) { chunked.sort(renumbered.finished, map); }
};

/// Likewise of a mesh with copies.
struct TrianglesByWedge {
  std::size_t read = 0;
  partition::Renumbered<WedgeRank> renumbered;
  std::vector<partition::RankTriangle> triangles;
  std::vector<WedgedTriangle> wedged;
  ChunkedTriangles chunked;

  void sort(const partition::ChunkMap& map) {
    triangles.clear();
    wedged.clear();
    for (const auto& [a, b, c] : renumbered.finished) {
      const partition::RankTriangle ranks{a.rank, b.rank, c.rank};
      if ((a.wedge | b.wedge | c.wedge) == 0)
        triangles.push_back(ranks);
      else
        wedged.push_back({ranks, {a.wedge, b.wedge, c.wedge}});
    }
    chunked.sort(triangles, map);
    chunked.sort_wedged(wedged, map);
  }
};

/// Gives triangles to the chunks that they touch, through a table of ranks.
template <class Slot, class Rank>
class TriangleDistribution {
 public:
  TriangleDistribution(SourceMesh& mesh, Renumberer<Rank> renumberer, Chunks& chunks,
                       const StageContext& context)
      : mesh_(mesh), renumberer_(std::move(renumberer)), chunks_(chunks), context_(context) {}

  /// As SourceMesh::read_triangle_blocks().
  FaceBlocks take_blocks(const Share& share) {
    return mesh_.read_triangle_blocks<Slot>(
        share, in_flight(), context_.cancel,
        [&](std::span<const Triangle<VertexId>> triangles, Slot& slot) { sort(triangles, slot); },
        [&](const Slot& slot) { keep_read(slot); });
  }
  /// As SourceMesh::read_triangles_from().
  mesh_io::FaceCounts take_from(std::uint64_t face) {
    return mesh_.read_triangles_from<Slot>(
        face, in_flight(), context_.cancel,
        [&](std::span<const Triangle<VertexId>> triangles, Slot& slot) { sort(triangles, slot); },
        [&](const Slot& slot) { keep_read(slot); });
  }
  /// Those that wait for a part of the table. Call once, at the end.
  void finish() {
    while (renumberer_.next_round()) {
      execution::ordered_blocks<Slot>(
          renumberer_.batches(), in_flight(), context_.cancel,
          [&](std::uint64_t batch, Slot& slot) {
            renumberer_.translate_batch(batch, slot.renumbered);
            slot.sort(chunks_.map());
          },
          [&](const Slot& slot) {
            keep(slot);
            return true;
          });
    }
  }

 private:
  std::size_t in_flight() const { return context_.memory().blocks_in_flight; }
  void sort(std::span<const Triangle<VertexId>> triangles, Slot& slot) const {
    slot.read = triangles.size();
    renumberer_.translate(triangles, slot.renumbered);
    slot.sort(chunks_.map());
  }
  void keep(const Slot& slot) {
    renumberer_.keep(slot.renumbered);
    chunks_.append(slot.chunked);
  }
  void keep_read(const Slot& slot) {
    keep(slot);
    context_.progress.advance(slot.read);
  }

  SourceMesh& mesh_;
  Renumberer<Rank> renumberer_;
  Chunks& chunks_;
  const StageContext& context_;
};

template <class Slot, class Rank>
mesh_io::FaceCounts distribute_faces(SourceMesh& mesh, Renumberer<Rank> renumberer, Chunks& chunks,
                                     const StageContext& context) {
  context.progress.stage(kStage, mesh.declared_faces(), "triangles");
  TriangleDistribution<Slot, Rank> triangles(mesh, std::move(renumberer), chunks, context);
  const mesh_io::FaceCounts blocks = triangles.take_blocks({}).counts;
  const mesh_io::FaceCounts rest = triangles.take_from(blocks.faces);
  triangles.finish();
  return blocks + rest;
}

/// Vertices, then triangles. `passing`: for what is needed meanwhile only.
mesh_io::FaceCounts distribute(SourceMesh& mesh, const importing::CopyList& copies,
                               const TopTree& top, Chunks& chunks, storage::ScratchFile& passing,
                               const StageContext& context) {
  const std::uint64_t count = mesh.summary().vertices;
  context.progress.stage(kStage, count, "vertices");
  const auto triangles = [&]<class Slot>(auto& table, Slot) {
    execution::release_free_memory();
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

/// Those that a share of the faces names. Reads the faces.
IdRange ids_of(SourceMesh& mesh, const Share& share, const StageContext& context) {
  IdRange all;
  mesh.read_triangle_blocks<IdRange>(
      share, context.memory().blocks_in_flight, context.cancel,
      [](std::span<const Triangle<VertexId>> triangles, IdRange& ids) {
        ids = {};
        for (const Triangle<VertexId>& t : triangles)
          ids.add({std::min({raw(t[0]), raw(t[1]), raw(t[2])}),
                   std::max({raw(t[0]), raw(t[1]), raw(t[2])})});
      },
      [&](const IdRange& ids) { all.add(ids); });
  return all;
}

/// Ranks of ascending ids, one by one.
class RankCursor {
 public:
  RankCursor(const SlicedRanks& ranks, std::uint64_t vertices)
      : ranks_(ranks), vertices_(vertices) {}

  /// Of a place by its first vertex.
  std::uint32_t operator()(std::uint32_t id) {
    if (id - first_ >= block_.size()) {
      first_ = id;
      block_.resize(
          std::clamp<std::uint64_t>(vertices_ - std::min<std::uint64_t>(id, vertices_), 1, kBlock));
      ranks_.read(first_, block_);
    }
    if (block_[id - first_] == SlicedRanks::kCopy)
      throw_unknown();
    return block_[id - first_];
  }

  [[noreturn]] static void throw_unknown() {
    throw Error(ErrorCode::corrupt,
                "the copies of a slice are not those of this mesh: plan the build again");
  }

 private:
  static constexpr std::uint64_t kBlock = 4096;
  const SlicedRanks& ranks_;
  std::uint64_t vertices_;
  std::uint32_t first_ = 0;
  std::vector<std::uint32_t> block_;
};

/// Calls take(ranked copy) for the copies among some ids, in their order.
template <class Take>
void rank_copies(const SlicedInput& input, const IdRange& ids, storage::ScratchFile& passing,
                 const StageContext& context, const Take& take) {
  if (ids.size() == 0)
    return;
  RankCursor rank_of(input.ranks, input.mesh.summary().vertices);
  partition::rank_copies(
      [&](const auto& visit) {
        input.copies.for_each(
            ids.first, std::uint64_t{ids.last} + 1, [&] { context.cancel.check(); }, visit);
      },
      [&](std::uint32_t first) { return rank_of(first); }, passing, context.memory().table_bytes,
      take);
}

/// The table of ranks of some ids, in their order, of a mesh with copies.
class WedgeTable {
 public:
  WedgeTable(const SlicedInput& input, const IdRange& ids, storage::ScratchFile& passing,
             const StageContext& context)
      : ranks_(input.ranks), copies_(passing, 1 << 18) {
    rank_copies(input, ids, passing, context,
                [&](const partition::RankedCopy& copy) { copies_.append(copy); });
    cursor_.emplace(copies_, context.cancel);
  }

  void read(std::uint64_t id, std::span<WedgeRank> values) {
    std::vector<std::uint32_t> ranks;
    while (!values.empty()) {
      ranks.resize(std::min<std::size_t>(values.size(), kBlock));
      ranks_.read(id, ranks);
      for (std::size_t i = 0; i < ranks.size(); ++i)
        values[i] = ranks[i] == SlicedRanks::kCopy ? copy(id + i) : WedgeRank{ranks[i], 0};
      values = values.subspan(ranks.size());
      id += ranks.size();
    }
  }

 private:
  static constexpr std::size_t kBlock = 16384;

  WedgeRank copy(std::uint64_t id) {
    if (next_ == copies_.size() || cursor_->at(next_).id != id)
      RankCursor::throw_unknown();
    return cursor_->at(next_++).rank;
  }

  const SlicedRanks& ranks_;
  storage::RecordSpool<partition::RankedCopy> copies_;
  std::optional<execution::SpoolCursor<partition::RankedCopy>> cursor_;
  std::uint64_t next_ = 0;
};

/// Calls distribute(triangles) with a TriangleDistribution whose table is that of some ids.
template <class Distribute>
auto with_table(SlicedInput& input, const IdRange& ids, Chunks& chunks,
                storage::ScratchFile& scratch, const StageContext& context,
                const Distribute& distribute) {
  storage::ScratchFile passing = scratch.beside("ranks");
  const std::uint64_t first = ids.size() == 0 ? 0 : ids.first;
  const auto run = [&]<class Slot, class Rank>(Slot, RenumberTable<Rank> table) {
    const partition::RenumberPlan plan =
        partition::plan_renumbering(table.entries, sizeof(Rank), context.memory().table_bytes);
    TriangleDistribution<Slot, Rank> triangles(
        input.mesh, Renumberer<Rank>(std::move(table), plan, passing), chunks, context);
    const auto result = distribute(triangles);
    triangles.finish();
    return result;
  };
  if (input.copies.empty()) {
    return run(TrianglesByRank{},
               RenumberTable<std::uint32_t>{first, ids.size(), [&](std::uint64_t id, auto ranks) {
                                              input.ranks.read(id, ranks);
                                            }});
  }
  WedgeTable table(input, ids, passing, context);
  return run(TrianglesByWedge{},
             RenumberTable<WedgeRank>{
                 first, ids.size(), [&](std::uint64_t id, auto ranks) { table.read(id, ranks); }});
}

/// Of so many, what a share of the blocks has about.
std::uint64_t about(std::uint64_t count, const Share& share) {
  return share.end(count) - share.begin(count);
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
    context.progress.stage(kStage, mesh.summary().vertices, "vertices");
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
        [&](const Slot& slot) { selector.add(slot.swept); });
    std::vector<partition::SplitPlane> planes = selector.settle(plan);
    if (!planes.empty())
      return {plan.chunks, std::move(planes)};
  }
}

mesh_io::FaceCounts partition_mesh(SourceMesh& mesh, const importing::CopyList& copies,
                                   Chunks& chunks, storage::ScratchFile& scratch,
                                   const StageContext& context) {
  const TopTree top = find_splits(mesh, copies, scratch, context);
  execution::release_free_memory();
  storage::ScratchFile passing = scratch.beside("ranks");
  const mesh_io::FaceCounts counts = distribute(mesh, copies, top, chunks, passing, context);
  warn_of_wide_triangles(chunks, context);
  execution::release_free_memory();
  return counts;
}

void distribute_vertices(SlicedInput& input, const TopTree& top, const Share& slice, Chunks& chunks,
                         storage::RecordSpool<float>& copy_rows, const StageContext& context) {
  const SourceMesh& mesh = input.mesh;
  context.progress.stage(kStage, about(mesh.summary().vertices, slice), "vertices");
  std::uint64_t next = slice.begin(mesh.vertex_blocks());
  std::vector<std::uint32_t> ranks;
  const auto keep = [&](const std::vector<std::uint32_t>& of_places,
                        const DistributedBlock& block) {
    ranks.clear();
    auto place = of_places.begin();
    for (const CopyVertex& copy : block.places.copies) {
      const auto before = static_cast<std::ptrdiff_t>(copy.id - block.first - ranks.size());
      ranks.insert(ranks.end(), place, place + before);
      ranks.push_back(SlicedRanks::kCopy);
      place += before;
    }
    ranks.insert(ranks.end(), place, of_places.end());
    input.ranks.put(next++, ranks);
    copy_rows.append(std::span<const float>(block.copy_rows));
  };
  distribute_places<std::uint32_t>(mesh, input.copies, top, slice, chunks, keep, context);
}

void distribute_copies(SlicedInput& input, const Share& slice,
                       const storage::RecordSpool<float>& copy_rows, Chunks& chunks,
                       storage::ScratchFile& scratch, const StageContext& context) {
  storage::ScratchFile passing = scratch.beside("ranks");
  execution::SpoolCursor values(copy_rows, context.cancel);
  std::vector<float> row(chunks.row_width());
  std::uint64_t next = 0;
  rank_copies(input, input.ranks.ids_of(slice), passing, context,
              [&](const partition::RankedCopy& copy) {
                if (copy_rows.size() - next < row.size())
                  RankCursor::throw_unknown();
                for (float& value : row)
                  value = values.at(next++);
                chunks.append_copy(copy.rank.rank, row);
              });
}

FaceBlocks distribute_triangles(SlicedInput& input, const Share& slice, Chunks& chunks,
                                storage::ScratchFile& scratch, const StageContext& context) {
  context.progress.stage(kStage, about(input.mesh.declared_faces(), slice), "triangles");
  return with_table(input, ids_of(input.mesh, slice, context), chunks, scratch, context,
                    [&](auto& triangles) { return triangles.take_blocks(slice); });
}

mesh_io::FaceCounts distribute_triangles_from(std::uint64_t face, SlicedInput& input,
                                              Chunks& chunks, storage::ScratchFile& scratch,
                                              const StageContext& context) {
  const std::uint64_t left = input.mesh.declared_faces() - face;
  context.progress.stage(kStage, left, "triangles");
  const auto last = static_cast<std::uint32_t>(input.mesh.summary().vertices - 1);
  return with_table(input, left == 0 ? IdRange{} : IdRange{0, last}, chunks, scratch, context,
                    [&](auto& triangles) { return triangles.take_from(face); });
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

/// Of an entry of the table of ranks.
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
  // With so much the table of ranks is in memory as a whole, beside the spools of chunks.
  const std::uint64_t beside =
      2 * job.threads * block + spools.index_bytes(4 * ChunkSpools::kLeastBlock);
  const std::uint64_t table = (rank_bytes(job) * job.vertex_count + beside) /
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
      partition::plan_renumbering(job.vertex_count, rank_bytes(job), memory.table_bytes);
  const double waiting =
      job.has_copies()
          ? partition::expected_waiting_bytes<WedgeRank>(renumbering, job.face_count)
          : partition::expected_waiting_bytes<std::uint32_t>(renumbering, job.face_count);
  const double chunks = vertices * job.vertex_bytes() +
                        Chunks::expected_triangle_bytes(job.place_count, job.face_count,
                                                        job.wedged_triangles(), kBoundaryShare);
  // Copies: their list, and their rows until the ranks of their places are known; then the table is
  // there twice.
  const auto copies = static_cast<double>(job.vertex_count - job.place_count);
  const double list = copies * sizeof(CopyVertex);
  const double rows = copies * job.vertex_bytes();
  const double ranks = vertices * static_cast<double>(rank_bytes(job));
  using enum DiskMoment;
  return {{partition::expected_window_bytes(job.place_count), splits, splits, true},
          {list, splits, triangles, true},
          {ranks + (job.has_copies() ? std::max(rows, ranks) : 0), triangles, triangles, true},
          {waiting, triangles, triangles, true},
          {chunks + copies * sizeof(float), triangles, triangles, true},
          {chunks + copies * sizeof(float), noted, leaves}};
}

}  // namespace meshhier::pipeline
