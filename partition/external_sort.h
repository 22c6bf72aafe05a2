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

#include "partition/external_runs.h"
#include "partition/parallel_sort.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

namespace meshhier::partition {

/// Sorts trivially copyable records, which have no padding bytes, by `key_of(record)`, anything
/// with operator<. Records of equal keys come in the order of their bytes: the result depends on
/// the set of records alone, not on their arrival, the memory or the threads. (Who wants arrival
/// order puts a counter into record and key.) Call add() any number of times, sort() once, then
/// read; all from one thread at a time. Throws what the scratch file throws, as a full disk.
template <class Record, class KeyOf>
class ExternalSort final : public ExternalRuns {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// Holds at most `memory_bytes` (of 64 KiB or more) besides what the scratch file's pool grants
  /// to its spools; a small input takes no more than twice its size.
  ExternalSort(storage::ScratchFile& scratch, std::uint64_t memory_bytes, KeyOf key_of = {})
      : ExternalRuns(scratch, memory_bytes, {sizeof(Record), alignof(Record)}), key_of_(key_of) {}

  void add(std::span<const Record> records);
  void add(const Record& record) {
    if (filled_ == capacity_)
      make_room();
    std::memcpy(buffer_.get() + filled_++ * sizeof(Record), &record, sizeof(Record));
    ++size_;
  }

  /// The next records in order; empty after the last. Valid until the next call.
  std::span<const Record> next_block();

  /// Hands all records that were not read yet to `visit(std::span<const Record>)`.
  template <class Visit>
  void for_each_block(Visit&& visit) {
    for (auto block = next_block(); !block.empty(); block = next_block())
      visit(block);
  }

 private:
  static std::span<Record> records_in(std::span<std::byte> bytes) {
    return {reinterpret_cast<Record*>(bytes.data()), bytes.size() / sizeof(Record)};
  }
  static const Record& record_at(const std::byte* place) {
    return *reinterpret_cast<const Record*>(place);
  }
  bool less(const Record& a, const Record& b) const {
    const auto key_a = key_of_(a), key_b = key_of_(b);
    if (key_a < key_b)
      return true;
    return !(key_b < key_a) && std::memcmp(&a, &b, sizeof(Record)) < 0;
  }

  void sort_buffer() override {
    parallel_sort(records_in({buffer_.get(), filled_ * sizeof(Record)}),
                  [this](const Record& a, const Record& b) { return less(a, b); });
  }
  bool beats(std::uint32_t a, std::uint32_t b) const override {
    if (inputs_[a].now == inputs_[a].end)
      return false;
    return inputs_[b].now == inputs_[b].end ||
           less(record_at(inputs_[a].now), record_at(inputs_[b].now));
  }
  std::size_t merge_some() override;

  KeyOf key_of_;
};

template <class Record, class KeyOf>
void ExternalSort<Record, KeyOf>::add(std::span<const Record> records) {
  while (!records.empty()) {
    if (filled_ == capacity_)
      make_room();
    const std::size_t count = std::min(records.size(), capacity_ - filled_);
    std::memcpy(buffer_.get() + filled_ * sizeof(Record), records.data(), count * sizeof(Record));
    filled_ += count;
    size_ += count;
    records = records.subspan(count);
  }
}

template <class Record, class KeyOf>
std::size_t ExternalSort<Record, KeyOf>::merge_some() {
  const auto count = static_cast<std::uint32_t>(inputs_.size());
  std::size_t filled = 0;
  while (filled < output_.size()) {
    std::uint32_t winner = losers_[0];
    Input& input = inputs_[winner];
    if (input.now == input.end)
      break;
    std::memcpy(&output_[filled], input.now, sizeof(Record));
    filled += sizeof(Record);
    input.now += sizeof(Record);
    if (input.now == input.end)
      read_on(input);
    // Only the matches that the run played can end otherwise now: those on its way to the root. Its
    // opponent in each is the loser kept there.
    for (std::uint32_t node = (winner + count) / 2; node > 0; node /= 2) {
      if (beats(losers_[node], winner))
        std::swap(losers_[node], winner);
    }
    losers_[0] = winner;
  }
  return filled / sizeof(Record);
}

template <class Record, class KeyOf>
std::span<const Record> ExternalSort<Record, KeyOf>::next_block() {
  assert(is_sorted());
  if (is_merged())
    return records_in(output_.first(merge_some() * sizeof(Record)));
  return records_in(std::exchange(output_, {}));
}

}  // namespace meshhier::partition
