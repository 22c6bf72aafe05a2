// From the ids of vertices to provisional ranks: what triangles are renumbered by.
#pragma once

#include "hierarchy/copy_vertex.h"
#include "partition/external_sort.h"
#include "partition/renumber.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace meshhier::partition {

/// A corner of a triangle, renumbered, where the mesh has copies.
struct WedgeRank {
  std::uint32_t rank;  ///< provisional, of the place
  std::uint32_t wedge;
};
static_assert(std::is_trivially_default_constructible_v<WedgeRank>);

/// A copy and its rank.
struct RankedCopy {
  std::uint32_t id = 0;
  WedgeRank rank{};
};

/// The keys that rank_copies() sorts by. They stand outside, so that a sort is compiled once for
/// all of its callers.
struct CopyFirst {
  std::uint32_t operator()(const CopyVertex& copy) const { return copy.first; }
};
struct RankedCopyId {
  std::uint32_t operator()(const RankedCopy& copy) const { return copy.id; }
};

/// Finds the ranks of copies. for_each(visit) calls visit(copy) for all of them in the order of
/// ids; rank_of(first) tells the rank of a place by its first vertex, in ascending order;
/// take(ranked copy) is called for each in the order of ids. O(n log n), by sorting in
/// `memory_bytes` besides what the scratch file's pool grants.
template <class ForEach, class RankOf, class Take>
void rank_copies(const ForEach& for_each, const RankOf& rank_of, storage::ScratchFile& scratch,
                 std::uint64_t memory_bytes, const Take& take) {
  ExternalSort<RankedCopy, RankedCopyId> by_id(scratch, memory_bytes / 2);
  {
    ExternalSort<CopyVertex, CopyFirst> by_first(scratch, memory_bytes / 2);
    for_each([&](const CopyVertex& copy) { by_first.add(copy); });
    by_first.sort();
    by_first.for_each_block([&](std::span<const CopyVertex> block) {
      for (const CopyVertex& copy : block)
        by_id.add({copy.id, {rank_of(copy.first), copy.slot}});
    });
  }
  by_id.sort();
  by_id.for_each_block([&](std::span<const RankedCopy> block) {
    for (const RankedCopy& copy : block)
      take(copy);
  });
}

/// `Rank`: std::uint32_t for meshes without copies, WedgeRank for others. In memory if it fits,
/// else in a spool.
template <class Rank>
class RankTable {
 public:
  /// Holds `memory_bytes` at most, besides what the scratch file's pool grants.
  RankTable(std::uint64_t vertex_count, std::uint64_t memory_bytes, storage::ScratchFile& scratch)
      : scratch_(scratch),
        memory_bytes_(memory_bytes),
        plan_(plan_renumbering(vertex_count, sizeof(Rank), memory_bytes)),
        count_(vertex_count),
        spooled_(scratch, kSpoolBytes),
        ranked_copies_(scratch, kSpoolBytes) {
    if (is_in_memory())
      table_ = std::make_unique_for_overwrite<Rank[]>(vertex_count);
  }

  bool is_in_memory() const { return plan_.blocks == 1; }

  /// The ranks of the ids from `first` on, with copies among them, whose ranks follow in settle().
  /// For a table in memory, in any order; thread-safe.
  void put(std::span<const Rank> ranks, std::uint64_t first, std::span<const CopyVertex> copies) {
    for_each_run(ranks, first, copies, [&](std::span<const Rank> run) {
      std::ranges::copy(run, table_.get() + first);
      first += run.size();
    });
  }
  /// The same for a spooled table, in the order of ids.
  void append(std::span<const Rank> ranks, std::uint64_t first,
              std::span<const CopyVertex> copies) {
    for_each_run(ranks, first, copies, [&](std::span<const Rank> run) { spooled_.append(run); });
  }

  /// Gives copies the ranks of their places. for_each(visit) calls visit(copy) for all copies in
  /// the order of ids; take(rank) is called for each in the same order. Call once, when all ids are
  /// there. O(n log n) in the copies, by sorting where the table is spooled.
  template <class ForEach, class Take>
  void settle(const ForEach& for_each, const Take& take) {
    is_in_memory() ? settle_in_memory(for_each, take) : settle_spooled(for_each, take);
  }

  /// Refers to the table. Call once.
  Renumberer<Rank> renumberer() {
    if (is_in_memory())
      return {std::move(table_), count_, scratch_};
    const auto read = [this](std::uint64_t id, std::span<Rank> values) {
      read_spooled(id, values);
    };
    return {{0, count_, read, true}, plan_, scratch_};
  }

 private:
  static constexpr std::size_t kSpoolBytes = 1 << 18;
  static constexpr Rank kUnknown{};

  /// Entries of a spool, asked for in ascending order.
  class Reader {
   public:
    explicit Reader(const storage::RecordSpool<Rank>& spool) : spool_(spool) {}
    Rank operator[](std::uint64_t i) {
      if (i >= first_ + block_.size()) {
        first_ = i;
        block_.resize(std::min(kBlock, spool_.size() - i));
        spool_.read(i, block_);
      }
      return block_[i - first_];
    }

   private:
    static constexpr std::uint64_t kBlock = 16384;
    const storage::RecordSpool<Rank>& spool_;
    std::uint64_t first_ = 0;
    std::vector<Rank> block_;
  };

  /// Calls visit(ranks) for those of the ids from `first` on, with unknown ones for copies.
  template <class Visit>
  static void for_each_run(std::span<const Rank> ranks, std::uint64_t first,
                           std::span<const CopyVertex> copies, const Visit& visit) {
    for (const CopyVertex& copy : copies) {
      const auto before = static_cast<std::size_t>(copy.id - first);
      visit(ranks.first(before));
      visit(std::span<const Rank>(&kUnknown, 1));
      ranks = ranks.subspan(before);
      first = std::uint64_t{copy.id} + 1;
    }
    visit(ranks);
  }

  template <class ForEach, class Take>
  void settle_in_memory(const ForEach& for_each, const Take& take) {
    for_each([&](const CopyVertex& copy) {
      table_[copy.id] = {table_[copy.first].rank, copy.slot};
      take(table_[copy.id].rank);
    });
  }

  template <class ForEach, class Take>
  void settle_spooled(const ForEach& for_each, const Take& take) {
    Reader firsts(spooled_);
    rank_copies(
        for_each, [&](std::uint32_t first) { return firsts[first].rank; }, scratch_, memory_bytes_,
        [&](const RankedCopy& copy) {
          ranked_copies_.append(copy);
          take(copy.rank.rank);
        });
  }

  /// Reads the ranks of the ids from `id` on, copies included. Thread-safe.
  void read_spooled(std::uint64_t id, std::span<Rank> values) const {
    spooled_.read(id, values);
    if constexpr (std::is_same_v<Rank, WedgeRank>) {
      std::array<RankedCopy, 256> some;
      for (std::uint64_t i = first_copy_from(id); i < ranked_copies_.size(); i += some.size()) {
        const std::span<RankedCopy> read =
            std::span(some).first(std::min<std::uint64_t>(some.size(), ranked_copies_.size() - i));
        ranked_copies_.read(i, read);
        for (const RankedCopy& copy : read) {
          if (copy.id - id >= values.size())
            return;
          values[copy.id - id] = copy.rank;
        }
      }
    }
  }

  /// The first of the ranked copies whose id is not below `id`.
  std::uint64_t first_copy_from(std::uint64_t id) const {
    std::uint64_t begin = 0, end = ranked_copies_.size();
    while (begin < end) {
      const std::uint64_t middle = (begin + end) / 2;
      RankedCopy copy;
      ranked_copies_.read(middle, std::span(&copy, 1));
      if (copy.id < id)
        begin = middle + 1;
      else
        end = middle;
    }
    return begin;
  }

  storage::ScratchFile& scratch_;
  std::uint64_t memory_bytes_;
  RenumberPlan plan_;
  std::uint64_t count_;
  std::unique_ptr<Rank[]> table_;
  storage::RecordSpool<Rank> spooled_;
  storage::RecordSpool<RankedCopy> ranked_copies_;  ///< by id
};

}  // namespace meshhier::partition
