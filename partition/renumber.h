// Translates triangles of ids into triangles of values, through a table that may be larger than
// memory.
//
// A table that fits is there as a whole. A larger one is never read at random: it is cut into
// blocks that fit two thirds of the memory, and one sweep goes over the blocks in order. A triangle
// waits in the bucket of the block that holds its least untranslated corner; when that block is
// loaded, all its corners there are translated, and the triangle is finished or goes on to the
// bucket of a later block ("time-forward processing", Chiang et al. 1995). While the first block is
// loaded the source is read, so triangles within it never wait at all.
//
//      table:     |  block 0  |  block 1  |  block 2  |  block 3  |     loaded one after another
//                                                                       ------ time ------>
//      (3, 7, 9)     done: the source is read while block 0 is loaded
//      (5, 1, 40)    5, 1 ............................. 40 done         one bucket
//      (17, 30, 44)              17 ..... 30 .......... 44 done         three buckets
//
// Invariant. A waiting triangle has no untranslated corner below the loaded block.
//
// Passes: the source once, the table once, and each triangle through as many buckets as its corners
// have blocks beyond the first of all: at most three, mostly one where ids are coherent. A triangle
// costs 12 bytes written and read for its first bucket, 3 sizeof(Value) + 4 for a later one. When
// the buckets are too many to have buffers of 16 KiB each, they come in groups (two levels, radix
// fashion), and a triangle passes at most one group more for each of its buckets.
#pragma once

#include "hierarchy/triangle.h"
#include "partition/bucketed.h"
#include "storage/io/spool.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <type_traits>
#include <vector>

namespace meshhier::partition {

/// How a table is cut into blocks, and blocks are grouped.
struct RenumberPlan {
  std::uint64_t block_entries = 0;  ///< of the table, held at a time
  std::uint64_t blocks = 1;
  std::uint64_t group_blocks = 1;  ///< blocks a group
  std::uint64_t groups = 1;
  std::uint64_t bucket_bytes = 0;  ///< buffer of each of a bucket's two spools
};

/// One block if the table fits `memory_bytes`. Memory below 64 KiB counts as 64 KiB.
RenumberPlan plan_renumbering(std::uint64_t entries, std::uint64_t entry_bytes,
                              std::uint64_t memory_bytes);

/// A triangle under way: a slot holds the corner's id while its bit of `open` is set, then its
/// value.
template <class Value>
struct WaitingTriangle {
  static constexpr std::size_t kSlot = std::max<std::size_t>(sizeof(Value), 4);
  std::array<std::byte, 3 * kSlot> slots;
  std::uint32_t open;
};

/// Bytes of the triangles that wait for blocks of the table, where most are there at once: all but
/// those within the first block, if they jump through the table at random or if it has its vertices
/// in several runs, as subdivided meshes do. Each waits in one place at a time, and places are used
/// again. A group of blocks is kept until all of it is handed on.
template <class Value>
double expected_waiting_bytes(const RenumberPlan& plan, std::uint64_t triangles);

/// Some triangles after translation. Used again and again, it keeps its memory.
template <class Value>
struct Renumbered {
  std::vector<Triangle<Value>> finished;  ///< corners as they were

  // To wait, by what for:
  Bucketed<Triangle<std::uint32_t>> fresh;  ///< nothing translated yet
  Bucketed<WaitingTriangle<Value>> begun;
  std::vector<Triangle<std::uint32_t>> read_fresh;  ///< of a batch
  std::vector<WaitingTriangle<Value>> read_begun;
};

/// Where the values of the ids first, first + 1, ... come from.
template <class Value>
struct RenumberTable {
  std::uint64_t first = 0;  ///< id
  std::uint64_t entries = 0;
  /// Reads the values of the ids from `id` on. Called by several threads if `in_parallel`.
  std::function<void(std::uint64_t id, std::span<Value> values)> read;
  bool in_parallel = false;
};

/// Translates triangles in rounds:
///
///   translate() and keep() all triangles of the source;
///   while next_round(): translate_batch() and keep() all batches of the round.
///
/// These functions are thread-safe for different results, next_round() apart. Every triangle is in
/// `finished` of exactly one result, in any order.
template <class Value>
class Renumberer {
  static_assert(std::is_trivially_copyable_v<Value>);

 public:
  /// Memory: `plan`'s, and what the scratch file's pool grants. The table is read once.
  Renumberer(RenumberTable<Value> table, const RenumberPlan& plan, storage::ScratchFile& scratch);
  /// Entry i of the table is the value of id i. Refers to it.
  Renumberer(const storage::RecordSpool<Value>& table, const RenumberPlan& plan,
             storage::ScratchFile& scratch);
  /// The whole table in memory, so many values: nothing waits.
  Renumberer(std::unique_ptr<Value[]> table, std::uint64_t count, storage::ScratchFile& scratch);

  /// Ids are unsigned integers or enums of 32 bits. Throws Error(internal) if the table has no such
  /// id: sources check their ids.
  template <class Id>
  void translate(std::span<const Triangle<Id>> triangles, Renumbered<Value>& result) const;

  /// Adds the triangles of `result` that wait to their buckets.
  void keep(const Renumbered<Value>& result);

  /// Loads what the next triangles wait for; false if none is left. All of the round before must
  /// have been translated and kept.
  bool next_round();
  std::uint64_t batches() const;
  void translate_batch(std::uint64_t batch, Renumbered<Value>& result) const;

 private:
  using Waiting = WaitingTriangle<Value>;
  /// Triangles that wait for one block, or for a group of blocks.
  struct Bucket {
    storage::RecordSpool<Triangle<std::uint32_t>> fresh;  ///< nothing translated yet
    storage::RecordSpool<Waiting> begun;
    std::mutex mutex{};  ///< of who appends
    std::uint64_t fresh_batches() const { return (fresh.size() + kBatch - 1) / kBatch; }
    std::uint64_t begun_batches() const { return (begun.size() + kBatch - 1) / kBatch; }
  };

  /// Triangles read from a bucket at a time: a few hundred KiB.
  static constexpr std::uint64_t kBatch = 16384;
  /// Values that a thread reads at a time.
  static constexpr std::uint64_t kReadValues = std::uint64_t{1} << 18;

  void make_buckets();
  void load(std::uint64_t block);
  template <class Id>
  void translate(std::span<const Triangle<Id>> triangles, std::uint32_t first_id,
                 Renumbered<Value>& result) const;
  bool is_loaded(std::uint32_t id) const { return id - first_ < loaded_count_; }
  void route_fresh(const Triangle<std::uint32_t>& ids, Renumbered<Value>& result) const;
  void route_begun(Waiting& triangle, Renumbered<Value>& result) const;
  /// Number of the bucket that waits for `id`: those of this group's blocks, then all groups'.
  std::uint32_t bucket_of(std::uint32_t id) const;

  // Within, ids count from the table's first.
  RenumberTable<Value> table_;
  std::uint64_t entries_;
  RenumberPlan plan_;
  storage::ScratchFile& scratch_;
  std::uint64_t first_ = 0;  ///< id of the loaded block's first entry
  std::unique_ptr<Value[]> loaded_;
  std::uint64_t loaded_count_ = 0;
  std::uint64_t block_ = 0, group_ = 0;  ///< loaded
  std::vector<std::unique_ptr<Bucket>> buckets_;
  Bucket* draining_ = nullptr;
};

}  // namespace meshhier::partition

#include "partition/renumber_impl.h"
