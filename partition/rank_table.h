// From the ids of vertices to provisional ranks: what triangles are renumbered by.
#pragma once

#include "hierarchy/copy_vertex.h"
#include "partition/external_sort.h"
#include "partition/renumber.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::partition {

/// What a corner of a triangle becomes where the mesh has copies.
struct WedgeRank {
  std::uint32_t rank = 0;  ///< provisional, of the place
  std::uint32_t wedge = 0;
};

/// What the corner of a copy becomes.
struct RankedCopy {
  std::uint32_t id = 0;
  WedgeRank rank;
};

/// Finds the ranks of copies. for_each(visit) calls visit(copy) for all of them in the order of
/// ids; rank_of(first) tells the rank of a place by its first vertex, in ascending order;
/// take(ranked copy) is called for each in the order of ids. O(n log n), by sorting in
/// `memory_bytes` besides what the scratch file's pool grants.
template <class ForEach, class RankOf, class Take>
void rank_copies(const ForEach& for_each, const RankOf& rank_of, storage::ScratchFile& scratch,
                 std::uint64_t memory_bytes, const Take& take) {
  struct ByFirst {
    std::uint32_t operator()(const CopyVertex& copy) const { return copy.first; }
  };
  struct ById {
    std::uint32_t operator()(const RankedCopy& copy) const { return copy.id; }
  };
  ExternalSort<RankedCopy, ById> by_id(scratch, memory_bytes / 2);
  {
    ExternalSort<CopyVertex, ByFirst> by_first(scratch, memory_bytes / 2);
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
        spooled_(scratch, kSpoolBytes) {
    if (is_in_memory())
      table_.reserve(vertex_count);
  }

  /// The ranks of the next ids.
  void append(std::span<const Rank> ranks) {
    is_in_memory() ? void(table_.insert(table_.end(), ranks.begin(), ranks.end()))
                   : spooled_.append(ranks);
  }
  /// Likewise from id `first` on, with copies among them, whose ranks follow in settle().
  void append(std::span<const Rank> ranks, std::uint64_t first,
              std::span<const CopyVertex> copies) {
    for (const CopyVertex& copy : copies) {
      const auto before = static_cast<std::size_t>(copy.id - first);
      append(ranks.first(before));
      append(std::span<const Rank>(&kUnknown, 1));
      ranks = ranks.subspan(before);
      first = std::uint64_t{copy.id} + 1;
    }
    append(ranks);
  }

  /// Gives copies the ranks of their places. for_each(visit) calls visit(copy) for all copies in
  /// the order of ids; take(rank) is called for each in the same order. Call once, when all ids are
  /// there. O(n log n) in the copies, by sorting where the table is spooled.
  template <class ForEach, class Take>
  void settle(const ForEach& for_each, const Take& take) {
    is_in_memory() ? settle_in_memory(for_each, take) : settle_spooled(for_each, take);
  }

  /// Call once.
  Renumberer<Rank> renumberer() {
    if (is_in_memory())
      return {std::move(table_), scratch_};
    return {settled_ ? *settled_ : spooled_, plan_, scratch_};
  }

 private:
  static constexpr std::size_t kSpoolBytes = 1 << 18;
  static constexpr Rank kUnknown{};

  /// Entries of a spool, asked for in ascending order.
  class Reader {
   public:
    explicit Reader(const storage::RecordSpool<Rank>& spool) : spool_(spool) {}
    const Rank& operator[](std::uint64_t i) {
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

  bool is_in_memory() const { return plan_.blocks == 1; }

  template <class ForEach, class Take>
  void settle_in_memory(const ForEach& for_each, const Take& take) {
    for_each([&](const CopyVertex& copy) {
      table_[copy.id] = {table_[copy.first].rank, copy.slot};
      take(table_[copy.id].rank);
    });
  }

  template <class ForEach, class Take>
  void settle_spooled(const ForEach& for_each, const Take& take) {
    storage::RecordSpool<Rank>& settled = settled_.emplace(scratch_, kSpoolBytes);
    Reader firsts(spooled_), table(spooled_);
    std::uint64_t next = 0;
    const auto copy_until = [&](std::uint64_t id) {
      for (; next < id; ++next)
        settled.append(table[next]);
    };
    rank_copies(
        for_each, [&](std::uint32_t first) { return firsts[first].rank; }, scratch_, memory_bytes_,
        [&](const RankedCopy& copy) {
          copy_until(copy.id);
          settled.append(copy.rank);
          ++next;
          take(copy.rank.rank);
        });
    copy_until(spooled_.size());
    spooled_.clear();
  }

  storage::ScratchFile& scratch_;
  std::uint64_t memory_bytes_;
  RenumberPlan plan_;
  std::vector<Rank> table_;
  storage::RecordSpool<Rank> spooled_;
  std::optional<storage::RecordSpool<Rank>> settled_;  ///< with the ranks of copies
};

}  // namespace meshhier::partition
