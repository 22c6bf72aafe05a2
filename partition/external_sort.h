// Sorts more records than fit in memory: runs sorted in memory, then streaming merges by a loser
// tree (Knuth, The Art of Computer Programming 3, section 5.4.1).
//
//      add():  | memory full | memory full | memory full | rest |      records as they come
//                     |             |             |          |
//      runs:        [a..z]        [b..y]        [a..x]     [c..w]      each sorted, in a spool
//                      \             \           /          /
//      sort(), next_block():      a loser tree over the runs' heads
//
//      The tree's leaves are the runs; each inner node keeps the loser of the match between its two
//      subtrees, losers_[0] the winner of all. When the winner's run moves on, only the matches on
//      its way to the root are played again: log2(runs) comparisons a record.
//
//                losers_[0]: run 2                      the winner
//                       [1]: run 0
//                      /            \                   each the loser of its match
//              [2]: run 1            [3]: run 3
//              /      \              /      \           leaves, nodes 4 to 7: not stored
//           run 0    run 1        run 2    run 3
//
// Invariant. The order is total: equal keys are ordered by the records' bytes. So neither the cuts
// between runs, nor the number of merges, nor threads show in the result.
//
// Cost. O(n log n). No bytes are moved if the records fit in memory; else every record is written
// once and read once. One merge takes memory / 64 KiB runs of memory bytes each (4 GiB from 16 MiB,
// 64 GiB from 64 MiB); the excess, and it alone, goes through one merge more.
#pragma once

#include "partition/parallel_sort.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace meshhier::partition {

/// Sorts trivially copyable records, which have no padding bytes, by `key_of(record)`, anything
/// with operator<. Records of equal keys come in the order of their bytes: the result depends on
/// the set of records alone, not on their arrival, the memory or the threads. (Who wants arrival
/// order puts a counter into record and key.) Call add() any number of times, sort() once, then
/// read; all from one thread at a time. Throws what the scratch file throws, as a full disk.
template <class Record, class KeyOf>
class ExternalSort {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// Holds at most `memory_bytes` (of 64 KiB or more) besides what the scratch file's pool grants
  /// to its spools; a small input takes no more than twice its size.
  ExternalSort(storage::ScratchFile& scratch, std::uint64_t memory_bytes, KeyOf key_of = {})
      : scratch_(scratch), memory_(std::max(memory_bytes, kLeastMemory)), key_of_(key_of) {}

  void add(std::span<const Record> records);
  void add(const Record& record) {
    if (filled_ == capacity_)
      make_room();
    std::memcpy(static_cast<void*>(buffer_.get() + filled_++), &record, sizeof(Record));
    ++size_;
  }

  /// Ends adding. In parallel on the caller's TBB arena.
  void sort();

  /// The next records in order; empty after the last. Valid until the next call.
  std::span<const Record> next_block();

  /// Hands all records that were not read yet to `visit(std::span<const Record>)`.
  template <class Visit>
  void for_each_block(Visit&& visit) {
    for (auto block = next_block(); !block.empty(); block = next_block())
      visit(block);
  }

  std::uint64_t size() const { return size_; }
  /// Bytes that went through spools, counted once (each is written and read).
  std::uint64_t spilled_bytes() const { return spilled_ * sizeof(Record); }

 private:
  using Spool = storage::RecordSpool<Record>;
  /// Records [begin, end) of a spool, sorted.
  struct Run {
    const Spool* spool;
    std::uint64_t begin, end;
    std::uint64_t size() const { return end - begin; }
  };
  /// A run being merged: what is in memory of it, and the room for more.
  struct Input {
    Run rest;
    Record* room;
    const Record* now;
    const Record* end;
  };
  struct Free {
    void operator()(Record* p) const { ::operator delete (p, std::align_val_t{alignof(Record)}); }
  };

  static constexpr std::uint64_t kLeastMemory = 65536;
  /// A run is read in blocks of this size: a disk's sequential rate needs about that.
  static constexpr std::uint64_t kReadBytes = 65536;
  /// Grain of the spools: large writes, but small beside the memory.
  static constexpr std::uint64_t kSpoolBytes = 1 << 20;
  /// First capacity is about this; doubled as records come.
  static constexpr std::uint64_t kFirstBytes = 65536;

  /// Records in memory: all of it but the open blocks of the two spools of a merge.
  std::size_t limit() const { return std::max<std::size_t>(memory_ / 8 * 7 / sizeof(Record), 64); }
  /// Runs that one merge takes, a part of the memory being for its output.
  std::size_t fan_in() const {
    const std::uint64_t read_bytes =
        std::max<std::uint64_t>(std::min(kReadBytes, memory_ / 16), sizeof(Record));
    return std::max<std::size_t>(limit() * sizeof(Record) / read_bytes, 4) - 1;
  }
  bool less(const Record& a, const Record& b) const {
    const auto key_a = key_of_(a), key_b = key_of_(b);
    if (key_a < key_b)
      return true;
    return !(key_b < key_a) && std::memcmp(&a, &b, sizeof(Record)) < 0;
  }

  void make_room();
  std::span<Record> sorted_buffer();
  void spill_run();
  void new_spool();
  void reduce_runs();
  void start_merge(std::span<const Run> runs);
  std::size_t merge_some();
  void advance(Input& input);
  bool beats(std::uint32_t a, std::uint32_t b) const;

  storage::ScratchFile& scratch_;
  std::uint64_t memory_;
  KeyOf key_of_;
  std::unique_ptr<Record[], Free>
      buffer_;  ///< unsorted records, later the merge's input and output
  std::size_t capacity_ = 0, filled_ = 0;
  std::uint64_t size_ = 0, spilled_ = 0;
  std::vector<std::unique_ptr<Spool>> spools_;
  std::vector<Run> runs_;
  std::vector<Input> inputs_;
  std::vector<std::uint32_t> losers_;  ///< [0] the winner, [i] the loser of the match at node i
  std::span<Record> output_;
  bool sorted_ = false;
};

template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::add(std::span<const Record> records) {
  while (!records.empty()) {
    if (filled_ == capacity_)
      make_room();
    const std::size_t count = std::min(records.size(), capacity_ - filled_);
    std::memcpy(static_cast<void*>(buffer_.get() + filled_), records.data(),
                count * sizeof(Record));
    filled_ += count;
    size_ += count;
    records = records.subspan(count);
  }
}

/// Grows the buffer through limit / 2^k: copying into the next one never touches more than the
/// limit.
template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::make_room() {
  assert(!sorted_);
  if (capacity_ == limit())
    return spill_run();
  std::size_t next = limit();
  const std::size_t least = std::max<std::size_t>(kFirstBytes / sizeof(Record), 2 * capacity_);
  while (next / 2 >= least && next / 2 > capacity_)
    next /= 2;
  std::unique_ptr<Record[], Free> larger(static_cast<Record*>(
      ::operator new (next * sizeof(Record), std::align_val_t{alignof(Record)})));
  if (filled_ > 0) {
    std::memcpy(static_cast<void*>(larger.get()), buffer_.get(), filled_ * sizeof(Record));
  }
  buffer_ = std::move(larger);
  capacity_ = next;
}

template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::new_spool() {
  const std::uint64_t bytes = std::min(kSpoolBytes, memory_ / 16);
  spools_.push_back(
      std::make_unique<Spool>(scratch_, std::max<std::size_t>(bytes, sizeof(Record))));
}

template <class Record, class KeyOf>
std::span<Record> ExternalSort<Record, KeyOf>::sorted_buffer() {
  const std::span<Record> records(buffer_.get(), filled_);
  parallel_sort(records, [this](const Record& a, const Record& b) { return less(a, b); });
  return records;
}

template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::spill_run() {
  const std::span<Record> run = sorted_buffer();
  if (spools_.empty())
    new_spool();
  const Spool& spool = *spools_.back();
  runs_.push_back({&spool, spool.size(), spool.size() + filled_});
  spools_.back()->append(run);
  spilled_ += filled_;
  filled_ = 0;
}

template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::sort() {
  assert(!sorted_);
  if (runs_.empty()) {
    output_ = sorted_buffer();
  } else {
    if (filled_ > 0)
      spill_run();
    while (runs_.size() > fan_in())
      reduce_runs();
    start_merge(runs_);
  }
  sorted_ = true;
}

/// Merges the first runs until one merge can take the rest, or once around.
template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::reduce_runs() {
  new_spool();
  std::vector<Run> reduced;
  std::size_t first = 0, left = runs_.size();
  while (left > fan_in() && first + 1 < runs_.size()) {
    // Merging k runs makes k - 1 fewer: no more than it takes to come down to one merge.
    const std::size_t count = std::min({fan_in(), runs_.size() - first, left - fan_in() + 1});
    const std::uint64_t begin = spools_.back()->size();
    start_merge(std::span(runs_).subspan(first, count));
    for (std::size_t n = merge_some(); n > 0; n = merge_some()) {
      spools_.back()->append(output_.first(n));
      spilled_ += n;
    }
    reduced.push_back({spools_.back().get(), begin, spools_.back()->size()});
    first += count;
    left -= count - 1;
  }
  reduced.insert(reduced.end(), runs_.begin() + static_cast<std::ptrdiff_t>(first), runs_.end());
  runs_ = std::move(reduced);
}

/// The buffer becomes one room per run, and the output's.
template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::start_merge(std::span<const Run> runs) {
  const auto count = static_cast<std::uint32_t>(runs.size());
  const std::size_t room = capacity_ / (count + 1);
  output_ = {buffer_.get() + count * room, room};
  inputs_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    inputs_.push_back({runs[i], buffer_.get() + i * room, nullptr, nullptr});
    advance(inputs_.back());
  }

  // The first round plays all matches from the leaves up, as in a heap: node i's are 2 i, 2 i + 1.
  losers_.assign(count, 0);
  std::vector<std::uint32_t> winners(2 * count);
  for (std::uint32_t i = 0; i < count; ++i)
    winners[count + i] = i;
  for (std::uint32_t node = count - 1; node > 0; --node) {
    std::uint32_t a = winners[2 * node], b = winners[2 * node + 1];
    if (beats(b, a))
      std::swap(a, b);
    winners[node] = a;
    losers_[node] = b;
  }
  losers_[0] = winners[1];
}

/// Steps over the current record; reads on if it was the last in memory.
template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::advance(Input& input) {
  if (input.now != input.end && ++input.now != input.end)
    return;
  const std::size_t count = std::min<std::uint64_t>(output_.size(), input.rest.size());
  if (count > 0)
    input.rest.spool->read(input.rest.begin, {input.room, count});
  input.rest.begin += count;
  input.now = input.room;
  input.end = input.room + count;
}

/// The record of run `a` comes before that of run `b`; a finished run comes last.
template <class Record, class KeyOf>
bool ExternalSort<Record, KeyOf>::beats(std::uint32_t a, std::uint32_t b) const {
  if (inputs_[a].now == inputs_[a].end)
    return false;
  return inputs_[b].now == inputs_[b].end || less(*inputs_[a].now, *inputs_[b].now);
}

/// Fills output_ from the start; returns how many there were.
template <class Record, class KeyOf>
std::size_t ExternalSort<Record, KeyOf>::merge_some() {
  const auto count = static_cast<std::uint32_t>(inputs_.size());
  std::size_t filled = 0;
  while (filled < output_.size()) {
    std::uint32_t winner = losers_[0];
    Input& input = inputs_[winner];
    if (input.now == input.end)
      break;
    std::memcpy(static_cast<void*>(&output_[filled++]), input.now, sizeof(Record));
    advance(input);
    // Only the matches that the run played can end otherwise now: those on its way to the root. Its
    // opponent in each is the loser kept there.
    for (std::uint32_t node = (winner + count) / 2; node > 0; node /= 2) {
      if (beats(losers_[node], winner))
        std::swap(losers_[node], winner);
    }
    losers_[0] = winner;
  }
  return filled;
}

template <class Record, class KeyOf>
std::span<const Record> ExternalSort<Record, KeyOf>::next_block() {
  assert(sorted_);
  if (!runs_.empty())
    return output_.first(merge_some());
  return std::exchange(output_, {});
}

}  // namespace meshhier::partition
