// Triangles of ids become triangles of values, through a table that may be larger than memory.
//
// A table that fits is loaded once. A larger one is never read at random: it is cut into blocks
// that fit half of the memory, and one sweep goes over the blocks in order. A triangle waits in the
// bucket of the block that holds its least untranslated corner; when that block is loaded, all its
// corners there are translated, and the triangle is finished or goes on to the bucket of a later
// block ("time-forward processing", Chiang et al. 1995). While the first block is loaded the source
// is read, so what lies in it never waits at all.
//
// Passes: the source once, the table once, and each triangle through as many buckets as its corners
// have blocks beyond the first of all: at most three, mostly one where ids are coherent. A triangle
// costs 12 bytes written and read for its first bucket, 3 sizeof(Value) + 4 for a later one. When
// the buckets are too many to have buffers of 16 KiB each, they come in groups (two levels, radix
// fashion), and a triangle passes at most one group more for each of its buckets.
#pragma once

#include "hierarchy/error.h"
#include "storage/spool.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <tbb/parallel_for.h>

namespace meshhier::partition {

using IdTriangle = std::array<std::uint32_t, 3>;

struct RenumberReport {
  std::uint64_t triangles = 0;
  std::uint64_t table_blocks = 1;   ///< 1: the table fitted
  std::uint64_t spooled_bytes = 0;  ///< appended to spools; each is read once
};

/// How a table is cut into blocks, blocks are grouped, and what is held at a time.
struct RenumberPlan {
  std::uint64_t block_entries = 0;  ///< of the table, held at a time
  std::uint64_t blocks = 1;
  std::uint64_t group_blocks = 1;  ///< blocks a group
  std::uint64_t groups = 1;
  std::uint64_t bucket_bytes = 0;  ///< buffer of each of a bucket's two spools
  std::uint64_t batch = 0;         ///< triangles read from a bucket and handed on at a time
};

/// Memory below 64 KiB counts as 64 KiB.
RenumberPlan plan_renumbering(std::uint64_t entries, std::uint64_t entry_bytes,
                              std::uint64_t memory_bytes);

template <class Value, class Sink>
class Renumberer {
  static_assert(std::is_trivially_copyable_v<Value>);

 public:
  Renumberer(const storage::RecordSpool<Value>& table, const RenumberPlan& plan,
             storage::ScratchFile& scratch, Sink& sink)
      : table_(table), plan_(plan), scratch_(scratch), sink_(sink) {}

  template <class ReadTriangles>
  RenumberReport run(ReadTriangles&& read_triangles);

 private:
  using Result = std::array<Value, 3>;
  static constexpr std::size_t kSlot = std::max<std::size_t>(sizeof(Value), 4);

  /// A triangle under way: a slot holds the corner's id while its bit of `open` is set, then its
  /// value.
  struct Waiting {
    std::array<std::byte, 3 * kSlot> slots;
    std::uint32_t open;

    std::uint32_t id(std::size_t corner) const { return get<std::uint32_t>(corner); }
    template <class T>
    T get(std::size_t corner) const {
      T value;
      std::memcpy(&value, &slots[corner * kSlot], sizeof value);
      return value;
    }
    template <class T>
    void set(std::size_t corner, const T& value) {
      std::memcpy(&slots[corner * kSlot], &value, sizeof value);
    }
  };

  /// Triangles that wait for one block, or for a group of blocks.
  struct Bucket {
    storage::RecordSpool<IdTriangle> fresh;  ///< nothing translated yet
    storage::RecordSpool<Waiting> begun;
  };

  IdTriangle checked(const auto& triangle) const;
  void translate_at_once(auto triangles);
  void make_buckets();
  void load(std::uint64_t block);
  void add(const IdTriangle& ids);
  void route(Waiting& triangle);
  Bucket& bucket_of(std::uint32_t id);
  void drain(Bucket& bucket);
  void flush();

  const storage::RecordSpool<Value>& table_;
  const RenumberPlan plan_;
  storage::ScratchFile& scratch_;
  Sink& sink_;
  std::uint64_t first_ = 0;  ///< id of the loaded block's first entry
  std::vector<Value> loaded_;
  std::uint64_t group_ = 0;         ///< of the loaded block
  std::vector<Bucket> near_, far_;  ///< blocks of this group, all groups
  std::vector<Result> out_;
  RenumberReport report_;
};

/// Translates every triangle of `read_triangles`, in an unspecified but deterministic order.
///
///   read_triangles(visit)  called once; hands std::span<const std::array<Id, 3>> to `visit` in any
///                          number of calls; Id an unsigned integer or enum of 32 bits
///   table                  its entry i is the value of id i; Value is trivially copyable
///   memory_bytes           64 KiB or more (4 MiB is enough for any table); held besides what the
///                          scratch file's pool grants
///   sink(triangles)        takes std::span<const std::array<Value, 3>>, corners as they were
///
/// Throws Error(internal) if an id is not below table.size(): sources check their ids.
template <class Value, class ReadTriangles, class Sink>
RenumberReport renumber(ReadTriangles&& read_triangles, const storage::RecordSpool<Value>& table,
                        std::uint64_t memory_bytes, storage::ScratchFile& scratch, Sink&& sink) {
  const RenumberPlan plan = plan_renumbering(table.size(), sizeof(Value), memory_bytes);
  return Renumberer<Value, std::remove_reference_t<Sink>>(table, plan, scratch, sink)
      .run(read_triangles);
}

inline RenumberPlan plan_renumbering(std::uint64_t entries, std::uint64_t entry_bytes,
                                     std::uint64_t memory_bytes) {
  constexpr std::uint64_t kLeastMemory = 65536;
  constexpr std::uint64_t kMostBatch = 65536;  // as sources read: beyond it nothing is amortised
  constexpr std::uint64_t kGoodBuffer = 16384,
                          kMostBuffer = 1 << 18;  // bytes a disk likes to write
  const std::uint64_t memory = std::max(memory_bytes, kLeastMemory);
  const std::uint64_t slot = std::max<std::uint64_t>(entry_bytes, 4);
  RenumberPlan plan;
  if (entries * entry_bytes <= memory / 8 * 7) {
    plan.block_entries = std::max<std::uint64_t>(entries, 1);
    plan.batch = std::clamp<std::uint64_t>(memory / 8 / (3 * slot), 1, kMostBatch);
    return plan;
  }
  // Half of the memory for the block, a quarter for the buckets, a quarter for the batches: ids,
  // triangles under way and results.
  plan.block_entries = std::max<std::uint64_t>(memory / 2 / entry_bytes, 1);
  plan.blocks = (entries + plan.block_entries - 1) / plan.block_entries;
  plan.batch = std::clamp<std::uint64_t>(memory / 4 / (16 + 6 * slot), 1, kMostBatch);
  plan.group_blocks = plan.blocks;
  if (plan.blocks * 2 * kGoodBuffer > memory / 4) {
    plan.group_blocks = 1;
    while (plan.group_blocks * plan.group_blocks < plan.blocks)
      ++plan.group_blocks;
  }
  plan.groups = (plan.blocks + plan.group_blocks - 1) / plan.group_blocks;
  const std::uint64_t spools = 2 * (plan.group_blocks + (plan.groups > 1 ? plan.groups : 0));
  plan.bucket_bytes = std::clamp<std::uint64_t>(memory / 4 / spools, 512, kMostBuffer);
  return plan;
}

template <class Value, class Sink>
template <class ReadTriangles>
RenumberReport Renumberer<Value, Sink>::run(ReadTriangles&& read_triangles) {
  report_.table_blocks = plan_.blocks;
  load(0);
  if (plan_.blocks == 1) {
    read_triangles([this](auto triangles) { translate_at_once(triangles); });
    return report_;
  }
  make_buckets();
  read_triangles([this](auto triangles) {
    for (const auto& triangle : triangles)
      add(checked(triangle));
    report_.triangles += triangles.size();
  });
  for (std::uint64_t block = 1; block < plan_.blocks; ++block) {
    load(block);
    if (block % plan_.group_blocks == 0)
      drain(far_[group_]);
    drain(near_[block % plan_.group_blocks]);
  }
  flush();
  return report_;
}

template <class Value, class Sink>
IdTriangle Renumberer<Value, Sink>::checked(const auto& triangle) const {
  IdTriangle ids;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    ids[corner] = static_cast<std::uint32_t>(triangle[corner]);
    if (ids[corner] < table_.size())
      continue;
    throw Error(ErrorCode::internal, "renumbering: a triangle refers to id " +
                                         std::to_string(ids[corner]) + ", the table has " +
                                         std::to_string(table_.size()) + " entries");
  }
  return ids;
}

/// The whole table is loaded: nothing waits.
template <class Value, class Sink>
void Renumberer<Value, Sink>::translate_at_once(auto triangles) {
  constexpr std::size_t kGrain = 4096;  // triangles a task: some 50 us, far above a task's cost
  report_.triangles += triangles.size();
  while (!triangles.empty()) {
    const std::size_t count = std::min<std::size_t>(plan_.batch, triangles.size());
    out_.resize(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const IdTriangle ids = checked(triangles[i]);
        out_[i] = {loaded_[ids[0]], loaded_[ids[1]], loaded_[ids[2]]};
      }
    });
    flush();
    triangles = triangles.subspan(count);
  }
}

template <class Value, class Sink>
void Renumberer<Value, Sink>::make_buckets() {
  const auto make = [this](std::vector<Bucket>& buckets, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      buckets.push_back({{scratch_, plan_.bucket_bytes}, {scratch_, plan_.bucket_bytes}});
    }
  };
  make(near_, plan_.group_blocks);
  make(far_, plan_.groups);
}

template <class Value, class Sink>
void Renumberer<Value, Sink>::load(std::uint64_t block) {
  first_ = block * plan_.block_entries;
  group_ = block / plan_.group_blocks;
  loaded_.resize(std::min(plan_.block_entries, table_.size() - first_));
  table_.read(first_, loaded_);
}

template <class Value, class Sink>
void Renumberer<Value, Sink>::add(const IdTriangle& ids) {
  Waiting triangle{.slots = {}, .open = 7};
  for (std::size_t corner = 0; corner < 3; ++corner)
    triangle.set(corner, ids[corner]);
  route(triangle);
}

/// Translates the corners in the loaded block; then the triangle is finished or waits for a later
/// one.
template <class Value, class Sink>
void Renumberer<Value, Sink>::route(Waiting& triangle) {
  const std::uint32_t before = triangle.open;
  std::uint32_t least = ~0u;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    if (!(before >> corner & 1))
      continue;
    const std::uint32_t id = triangle.id(corner);
    if (id - first_ < loaded_.size()) {  // ids below the block wrap around, but there are none
      triangle.set(corner, loaded_[id - first_]);
      triangle.open &= ~(1u << corner);
    } else {
      least = std::min(least, id);
    }
  }
  if (triangle.open == 0) {
    out_.push_back({triangle.template get<Value>(0), triangle.template get<Value>(1),
                    triangle.template get<Value>(2)});
    if (out_.size() == plan_.batch)
      flush();
  } else if (triangle.open == 7) {
    bucket_of(least).fresh.append({triangle.id(0), triangle.id(1), triangle.id(2)});
    report_.spooled_bytes += sizeof(IdTriangle);
  } else {
    bucket_of(least).begun.append(triangle);
    report_.spooled_bytes += sizeof(Waiting);
  }
}

template <class Value, class Sink>
typename Renumberer<Value, Sink>::Bucket& Renumberer<Value, Sink>::bucket_of(std::uint32_t id) {
  const std::uint64_t block = id / plan_.block_entries, group = block / plan_.group_blocks;
  return group == group_ ? near_[block % plan_.group_blocks] : far_[group];
}

template <class Value, class Sink>
void Renumberer<Value, Sink>::drain(Bucket& bucket) {
  std::vector<IdTriangle> fresh;
  for (std::uint64_t i = 0; i < bucket.fresh.size(); i += fresh.size()) {
    fresh.resize(std::min(plan_.batch, bucket.fresh.size() - i));
    bucket.fresh.read(i, fresh);
    for (const IdTriangle& ids : fresh)
      add(ids);
  }
  bucket.fresh.clear();
  std::vector<Waiting> begun;
  for (std::uint64_t i = 0; i < bucket.begun.size(); i += begun.size()) {
    begun.resize(std::min(plan_.batch, bucket.begun.size() - i));
    bucket.begun.read(i, begun);
    for (Waiting& triangle : begun)
      route(triangle);
  }
  bucket.begun.clear();
}

template <class Value, class Sink>
void Renumberer<Value, Sink>::flush() {
  if (!out_.empty())
    sink_(std::span<const Result>(out_));
  out_.clear();
}

}  // namespace meshhier::partition
