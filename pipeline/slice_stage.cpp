#include "pipeline/slice_stage.h"

#include "base/error.h"
#include "execution/spool_cursor.h"
#include "partition/rank_table.h"
#include "partition/renumber.h"
#include "pipeline/distribution.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::pipeline {
namespace {

using partition::Renumberer;
using partition::WedgeRank;

/// A set of ids in whole blocks: all that some triangles name, and their neighbours in the file.
class NamedIds {
 public:
  explicit NamedIds(std::uint64_t vertices = 0)
      : vertices_(vertices), blocks_((vertices + kBlock - 1) / kBlock) {}

  void add(VertexId id) { blocks_[raw(id) / kBlock] = 1; }
  void add(const NamedIds& other) {
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      blocks_[i] = static_cast<char>(blocks_[i] | other.blocks_[i]);
  }
  void add_all() { blocks_.assign(blocks_.size(), 1); }

  std::uint64_t first() const { return begin_of(std::ranges::find(blocks_, 1) - blocks_.begin()); }
  std::uint64_t end() const {
    return begin_of(std::find(blocks_.rbegin(), blocks_.rend(), 1).base() - blocks_.begin());
  }

  /// Calls visit(first, end) for the runs of them within [first, end).
  template <class Visit>
  void for_each_run(std::uint64_t first, std::uint64_t end, const Visit& visit) const {
    while (first < end) {
      const auto begin = blocks_.begin() + static_cast<std::ptrdiff_t>(first / kBlock);
      const auto other = std::find(begin, blocks_.end(), *begin == 0 ? 1 : 0);
      const std::uint64_t next = std::min(end, begin_of(other - blocks_.begin()));
      if (*begin != 0)
        visit(first, next);
      first = next;
    }
  }

 private:
  // The size is about that of a block of vertices, whose ranks are read as a whole.
  static constexpr std::uint64_t kBlock = 65536;

  std::uint64_t begin_of(std::ptrdiff_t block) const {
    return std::min(static_cast<std::uint64_t>(block) * kBlock, vertices_);
  }

  std::uint64_t vertices_;
  std::vector<char> blocks_;
};

/// Returns the ids that a share of the faces names. Reads the faces.
NamedIds ids_of(SourceMesh& mesh, const Share& share, const StageContext& context) {
  const std::uint64_t vertices = mesh.summary().vertices;
  NamedIds all(vertices);
  // Faces of a slice name vertices near each other, as a rule: then far fewer ranks than all are
  // read, which is worth reading the faces twice.
  mesh.read_triangle_blocks<NamedIds>(
      share, context.memory().blocks_in_flight, context.cancel,
      [&](std::span<const Triangle<VertexId>> triangles, NamedIds& ids) {
        ids = NamedIds(vertices);
        for (const Triangle<VertexId>& t : triangles) {
          for (const VertexId id : t)
            ids.add(id);
        }
      },
      [&](const NamedIds& ids) { all.add(ids); });
  return all;
}

/// Gives the ranks of ascending ids, one by one.
class RankCursor {
 public:
  RankCursor(const SlicedRanks& ranks, std::uint64_t vertices)
      : ranks_(ranks), vertices_(vertices) {}

  /// Returns the rank of a place, by the id of its first vertex.
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
  // A block of vertices has no more; its ranks are read as a whole.
  static constexpr std::uint64_t kBlock = 65536;
  const SlicedRanks& ranks_;
  std::uint64_t vertices_;
  std::uint32_t first_ = 0;
  std::vector<std::uint32_t> block_;
};

/// Calls take(ranked copy) for all copies that for_each(visit) visits, in the order of ids.
template <class ForEach, class Take>
void rank_copies(const SlicedInput& input, const ForEach& for_each, storage::ScratchFile& passing,
                 const StageContext& context, const Take& take) {
  RankCursor rank_of(input.ranks, input.mesh.summary().vertices);
  partition::rank_copies(
      for_each, [&](std::uint32_t first) { return rank_of(first); }, passing,
      context.memory().table_bytes, take);
}

/// The table of ranks of some ids, in their order, for a mesh with copies.
class WedgeTable {
 public:
  WedgeTable(const SlicedInput& input, const NamedIds& ids, storage::ScratchFile& passing,
             const StageContext& context)
      : ranks_(input.ranks), copies_(passing, 1 << 18) {
    const auto for_each = [&](const auto& visit) {
      ids.for_each_run(ids.first(), ids.end(), [&](std::uint64_t first, std::uint64_t end) {
        input.copies.for_each(
            first, end, [&] { context.cancel.check(); }, visit);
      });
    };
    rank_copies(input, for_each, passing, context,
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
  // So many are several blocks of vertices, whose ranks are read as a whole.
  static constexpr std::size_t kBlock = 262144;

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

/// Calls distribute(triangles) with a TriangleDistribution whose table has the ranks of some ids.
template <class Distribute>
auto with_table(SlicedInput& input, const NamedIds& ids, Chunks& chunks,
                storage::ScratchFile& scratch, const StageContext& context,
                const Distribute& distribute) {
  storage::ScratchFile passing = scratch.beside("ranks");
  const std::uint64_t first = ids.first();
  const std::uint64_t count = ids.end() - std::min(first, ids.end());
  const auto run = [&]<class Slot, class Rank>(Slot, Rank, auto& table) {
    const auto read = [&](std::uint64_t id, std::span<Rank> ranks) {
      ids.for_each_run(id, id + ranks.size(), [&](std::uint64_t begin, std::uint64_t end) {
        table.read(begin, ranks.subspan(begin - id, end - begin));
      });
    };
    const partition::RenumberPlan plan =
        partition::plan_renumbering(count, sizeof(Rank), context.memory().table_bytes);
    TriangleDistribution<Slot, Rank> triangles(
        input.mesh, Renumberer<Rank>({first, count, read}, plan, passing), chunks, context);
    const auto result = distribute(triangles);
    triangles.finish();
    return result;
  };
  if (input.copies.empty())
    return run(TrianglesByRank{}, std::uint32_t{}, input.ranks);
  WedgeTable table(input, ids, passing, context);
  return run(TrianglesByWedge{}, WedgeRank{}, table);
}

/// Returns about how many of `count` a share of the blocks has.
std::uint64_t about(std::uint64_t count, const Share& share) {
  return share.end(count) - share.begin(count);
}

}  // namespace

void distribute_vertices(SlicedInput& input, const partition::TopTree& top, const Share& slice,
                         Chunks& chunks, storage::RecordSpool<float>& copy_rows,
                         const StageContext& context) {
  const SourceMesh& mesh = input.mesh;
  context.progress.stage(kPartitionStage, about(mesh.summary().vertices, slice), "vertices");
  std::uint64_t next = slice.begin(mesh.vertex_blocks());
  std::vector<std::uint32_t> ranks;
  const auto keep = [&](const std::vector<std::uint32_t>& of_places,
                        const DistributedBlock& block) {
    ranks.clear();
    auto place = of_places.begin();
    for (const CopyVertex& copy : block.places.copies) {
      const std::uint64_t before = copy.id - block.first - ranks.size();
      if (before > static_cast<std::uint64_t>(of_places.end() - place))
        RankCursor::throw_unknown();
      const auto end = place + static_cast<std::ptrdiff_t>(before);
      ranks.insert(ranks.end(), place, end);
      ranks.push_back(SlicedRanks::kCopy);
      place = end;
    }
    ranks.insert(ranks.end(), place, of_places.end());
    input.ranks.put(next++, ranks);
    copy_rows.append(std::span<const float>(block.copy_rows));
  };
  const auto put = [](const std::vector<std::uint32_t>&, const DistributedBlock&) {};
  distribute_places<std::uint32_t>(mesh, input.copies, top, slice, chunks, keep, put, context);
}

void distribute_copies(SlicedInput& input, const Share& slice,
                       const storage::RecordSpool<float>& copy_rows, Chunks& chunks,
                       storage::ScratchFile& scratch, const StageContext& context) {
  const auto [first, end] = input.ranks.ids_of(slice);
  const auto for_each = [&, first = first, end = end](const auto& visit) {
    input.copies.for_each(
        first, end, [&] { context.cancel.check(); }, visit);
  };
  storage::ScratchFile passing = scratch.beside("ranks");
  execution::SpoolCursor values(copy_rows, context.cancel);
  std::vector<float> row(chunks.row_width());
  std::uint64_t next = 0;
  rank_copies(input, for_each, passing, context, [&](const partition::RankedCopy& copy) {
    if (copy_rows.size() - next < row.size())
      RankCursor::throw_unknown();
    for (float& value : row)
      value = values.at(next++);
    chunks.append_copy(copy.rank.rank, row);
  });
}

FaceBlocks distribute_triangles(SlicedInput& input, const Share& slice, Chunks& chunks,
                                storage::ScratchFile& scratch, const StageContext& context) {
  context.progress.stage(kPartitionStage, about(input.mesh.declared_faces(), slice), "triangles");
  return with_table(input, ids_of(input.mesh, slice, context), chunks, scratch, context,
                    [&](auto& triangles) { return triangles.take_blocks(slice); });
}

mesh_io::FaceCounts distribute_triangles_from(std::uint64_t face, SlicedInput& input,
                                              Chunks& chunks, storage::ScratchFile& scratch,
                                              const StageContext& context) {
  const std::uint64_t left = input.mesh.declared_faces() - face;
  context.progress.stage(kPartitionStage, left, "triangles");
  NamedIds ids(input.mesh.summary().vertices);
  if (left > 0)
    ids.add_all();
  return with_table(input, ids, chunks, scratch, context,
                    [&](auto& triangles) { return triangles.take_from(face); });
}

}  // namespace meshhier::pipeline
