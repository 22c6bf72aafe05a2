// The definitions of renumber.h, which includes this.
#pragma once

#include "base/error.h"
#include "partition/parallel_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

namespace meshhier::partition {

inline RenumberPlan plan_renumbering(std::uint64_t entries, std::uint64_t entry_bytes,
                                     std::uint64_t memory_bytes) {
  constexpr std::uint64_t kLeastMemory = 65536;
  constexpr std::uint64_t kGoodBuffer = 16384,
                          kMostBuffer = 1 << 18;  // bytes a disk likes to write
  const std::uint64_t memory = std::max(memory_bytes, kLeastMemory);
  RenumberPlan plan;
  if (entries * entry_bytes <= memory) {
    plan.block_entries = std::max<std::uint64_t>(entries, 1);
    return plan;
  }
  // Two thirds of the memory for the block, one for the buckets.
  plan.block_entries = std::max<std::uint64_t>(memory / 3 * 2 / entry_bytes, 1);
  plan.blocks = (entries + plan.block_entries - 1) / plan.block_entries;
  plan.group_blocks = plan.blocks;
  if (plan.blocks * 2 * kGoodBuffer > memory / 3) {
    plan.group_blocks = 1;
    while (plan.group_blocks * plan.group_blocks < plan.blocks)
      ++plan.group_blocks;
  }
  plan.groups = (plan.blocks + plan.group_blocks - 1) / plan.group_blocks;
  const std::uint64_t spools = 2 * (plan.group_blocks + (plan.groups > 1 ? plan.groups : 0));
  plan.bucket_bytes = std::clamp<std::uint64_t>(memory / 3 / spools, 512, kMostBuffer);
  return plan;
}

template <class Value>
double expected_waiting_bytes(const RenumberPlan& plan, std::uint64_t triangles) {
  if (plan.blocks == 1)
    return 0;
  const double group = plan.groups > 1 ? 1.0 / static_cast<double>(plan.groups) : 0;
  const auto blocks = static_cast<double>(plan.blocks);
  const double first = 1 / (blocks * blocks * blocks);
  return static_cast<double>(triangles) * sizeof(WaitingTriangle<Value>) * (1 - first + group);
}

template <class Value>
Renumberer<Value>::Renumberer(RenumberTable<Value> table, const RenumberPlan& plan,
                              storage::ScratchFile& scratch)
    : table_(std::move(table)), entries_(table_.entries), plan_(plan), scratch_(scratch) {
  if (plan_.blocks > 1)
    make_buckets();
  load(0);
}

template <class Value>
Renumberer<Value>::Renumberer(const storage::RecordSpool<Value>& table, const RenumberPlan& plan,
                              storage::ScratchFile& scratch)
    : Renumberer(
          {0, table.size(),
           [&table](std::uint64_t id, std::span<Value> values) { table.read(id, values); }, true},
          plan, scratch) {}

template <class Value>
Renumberer<Value>::Renumberer(std::unique_ptr<Value[]> table, std::uint64_t count,
                              storage::ScratchFile& scratch)
    : entries_(count), scratch_(scratch), loaded_(std::move(table)), loaded_count_(count) {
  plan_.block_entries = std::max<std::uint64_t>(entries_, 1);
}

template <class Value>
void Renumberer<Value>::make_buckets() {
  const std::uint64_t count = plan_.group_blocks + (plan_.groups > 1 ? plan_.groups : 0);
  for (std::uint64_t i = 0; i < count; ++i)
    buckets_.emplace_back(
        new Bucket{{scratch_, plan_.bucket_bytes}, {scratch_, plan_.bucket_bytes}});
}

template <class Value>
void Renumberer<Value>::load(std::uint64_t block) {
  block_ = block;
  group_ = block / plan_.group_blocks;
  first_ = block * plan_.block_entries;
  loaded_count_ = std::min(plan_.block_entries, entries_ - first_);
  if (!loaded_)
    loaded_ = std::make_unique_for_overwrite<Value[]>(loaded_count_);  // no block has more
  const std::uint64_t at_a_time =
      table_.in_parallel ? kReadValues : std::max<std::uint64_t>(loaded_count_, 1);
  for_each_part(loaded_count_, at_a_time, [&](std::uint64_t first, std::uint64_t count) {
    table_.read(table_.first + first_ + first, std::span(loaded_.get() + first, count));
  });
}

template <class Value>
std::uint32_t Renumberer<Value>::bucket_of(std::uint32_t id) const {
  const std::uint64_t block = id / plan_.block_entries, group = block / plan_.group_blocks;
  const std::uint64_t bucket =
      group == group_ ? block % plan_.group_blocks : plan_.group_blocks + group;
  return static_cast<std::uint32_t>(bucket);
}

template <class Value>
template <class Id>
void Renumberer<Value>::translate(std::span<const Triangle<Id>> triangles,
                                  Renumbered<Value>& result) const {
  translate(triangles, static_cast<std::uint32_t>(table_.first), result);
}

template <class Value>
template <class Id>
void Renumberer<Value>::translate(std::span<const Triangle<Id>> triangles, std::uint32_t first_id,
                                  Renumbered<Value>& result) const {
  result.finished.clear();
  result.fresh.clear(buckets_.size());
  result.begun.clear(buckets_.size());
  for (const Triangle<Id>& triangle : triangles) {
    Triangle<std::uint32_t> ids;
    for (std::size_t corner = 0; corner < 3; ++corner)
      ids[corner] = static_cast<std::uint32_t>(triangle[corner]) - first_id;
    const std::uint32_t greatest = std::max({ids[0], ids[1], ids[2]});
    if (greatest >= entries_) {
      throw Error(ErrorCode::internal, "renumbering: a triangle refers to id " +
                                           std::to_string(greatest) + ", the table has " +
                                           std::to_string(entries_) + " entries");
    }
    route_fresh(ids, result);
  }
}

template <class Value>
void Renumberer<Value>::route_fresh(const Triangle<std::uint32_t>& ids,
                                    Renumbered<Value>& result) const {
  const bool a = is_loaded(ids[0]), b = is_loaded(ids[1]), c = is_loaded(ids[2]);
  if (a && b && c) {
    result.finished.push_back(
        {loaded_[ids[0] - first_], loaded_[ids[1] - first_], loaded_[ids[2] - first_]});
  } else if (!a && !b && !c) {
    result.fresh.add(bucket_of(std::min({ids[0], ids[1], ids[2]})), ids);
  } else {
    Waiting triangle{.slots = {}, .open = 7};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      std::memcpy(&triangle.slots[corner * Waiting::kSlot], &ids[corner], sizeof ids[corner]);
    }
    route_begun(triangle, result);
  }
}

/// Translates the corners in the loaded block; then the triangle is finished or waits for a later
/// one.
template <class Value>
void Renumberer<Value>::route_begun(Waiting& triangle, Renumbered<Value>& result) const {
  std::uint32_t least = ~0u;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    if (!(triangle.open >> corner & 1))
      continue;
    std::byte* slot = &triangle.slots[corner * Waiting::kSlot];
    std::uint32_t id;
    std::memcpy(&id, slot, sizeof id);
    if (is_loaded(id)) {
      std::memcpy(slot, &loaded_[id - first_], sizeof(Value));
      triangle.open &= ~(1u << corner);
    } else {
      least = std::min(least, id);  // beyond the block: what lay before it is translated
    }
  }
  if (triangle.open != 0) {
    result.begun.add(bucket_of(least), triangle);
    return;
  }
  Triangle<Value>& finished = result.finished.emplace_back();
  for (std::size_t corner = 0; corner < 3; ++corner)
    std::memcpy(&finished[corner], &triangle.slots[corner * Waiting::kSlot], sizeof(Value));
}

template <class Value>
void Renumberer<Value>::keep(const Renumbered<Value>& result) {
  for (std::uint32_t b = 0; b < buckets_.size(); ++b) {
    if (!result.fresh.has(b) && !result.begun.has(b))
      continue;
    Bucket& bucket = *buckets_[b];
    const std::lock_guard lock(bucket.mutex);
    result.fresh.for_each(b, [&](const auto& ids) { bucket.fresh.append(ids); });
    result.begun.for_each(b, [&](const Waiting& triangle) { bucket.begun.append(triangle); });
  }
}

template <class Value>
bool Renumberer<Value>::next_round() {
  if (draining_ != nullptr) {
    draining_->fresh.clear();
    draining_->begun.clear();
  }
  if (block_ + 1 >= plan_.blocks)
    return false;
  load(block_ + 1);
  // Triangles for any block of a later group wait for the group; its first round tells them apart.
  const std::uint64_t in_group = block_ % plan_.group_blocks;
  draining_ = buckets_[in_group == 0 ? plan_.group_blocks + group_ : in_group].get();
  return true;
}

template <class Value>
std::uint64_t Renumberer<Value>::batches() const {
  return draining_->fresh_batches() + draining_->begun_batches();
}

template <class Value>
void Renumberer<Value>::translate_batch(std::uint64_t batch, Renumbered<Value>& result) const {
  const auto read = [](const auto& spool, std::uint64_t at, auto& records) {
    records.resize(std::min(kBatch, spool.size() - at * kBatch));
    spool.read(at * kBatch, records);
  };
  const std::uint64_t fresh_batches = draining_->fresh_batches();
  if (batch < fresh_batches) {
    read(draining_->fresh, batch, result.read_fresh);
    translate(std::span<const Triangle<std::uint32_t>>(result.read_fresh), 0, result);
    return;
  }
  translate(std::span<const Triangle<std::uint32_t>>(), 0, result);
  read(draining_->begun, batch - fresh_batches, result.read_begun);
  for (Waiting& triangle : result.read_begun)
    route_begun(triangle, result);
}

}  // namespace meshhier::partition
