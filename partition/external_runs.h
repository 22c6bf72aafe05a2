// The part of an ExternalSort that knows records by their size alone: the buffer, the runs in
// spools, the plan of the merges. It is compiled once; of a type of records only what compares them
// is.
#pragma once

#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <vector>

namespace meshhier::partition {

/// The size and the alignment of a record, in bytes.
struct RecordShape {
  std::size_t bytes, alignment;
};

/// Keeps records of one size in a buffer and in sorted runs, and plans their merges; the derived
/// class, which knows their order, fills the buffer, sorts it and merges. For one thread at a time.
class ExternalRuns {
 public:
  /// Ends adding; call it once. In parallel on the caller's TBB arena. Throws what the scratch file
  /// throws.
  void sort();

  std::uint64_t size() const { return size_; }
  /// Bytes that went through spools, counted once (each is written and read).
  std::uint64_t spilled_bytes() const { return spilled_ * record_.bytes; }

 protected:
  /// Records [begin, end) of a spool, sorted.
  struct Run {
    const storage::Spool* spool;
    std::uint64_t begin, end;
    std::uint64_t size() const { return end - begin; }
  };
  /// A run being merged: what is in memory of it, and the room for more.
  struct Input {
    Run rest;
    std::byte* room;
    const std::byte* now;
    const std::byte* end;
  };

  /// `memory_bytes` as for ExternalSort.
  ExternalRuns(storage::ScratchFile& scratch, std::uint64_t memory_bytes, RecordShape record);
  ExternalRuns(ExternalRuns&&) = default;
  ~ExternalRuns() = default;

  /// Sorts the records of the buffer, `filled_` of them.
  virtual void sort_buffer() = 0;
  /// Whether the record of run `a` comes before that of run `b`; a finished run comes last.
  virtual bool beats(std::uint32_t a, std::uint32_t b) const = 0;
  /// Fills `output_` from the start; returns the number of records.
  virtual std::size_t merge_some() = 0;

  /// Makes room for another record in the buffer, which is full.
  void make_room();
  /// Reads the next records of a run that has none in memory; none are left at its end.
  void read_on(Input& input) const;
  bool is_sorted() const { return sorted_; }
  /// Whether sorted records come from a merge, else all at once.
  bool is_merged() const { return !runs_.empty(); }

  struct Free {
    std::align_val_t alignment;
    void operator()(std::byte* p) const { ::operator delete(p, alignment); }
  };
  std::unique_ptr<std::byte[], Free>
      buffer_;                             ///< unsorted records, later the merge's input and output
  std::size_t capacity_ = 0, filled_ = 0;  ///< records of the buffer
  std::uint64_t size_ = 0;
  std::vector<Input> inputs_;
  std::vector<std::uint32_t> losers_;  ///< [0] the winner, [i] the loser of the match at node i
  std::span<std::byte> output_;

 private:
  std::size_t limit() const;
  std::size_t fan_in() const;
  void sort_into_output();
  void spill_run();
  void new_spool();
  void reduce_runs();
  void start_merge(std::span<const Run> runs);

  storage::ScratchFile& scratch_;
  std::uint64_t memory_;
  RecordShape record_;
  std::uint64_t spilled_ = 0;  ///< records
  std::vector<std::unique_ptr<storage::Spool>> spools_;
  std::vector<Run> runs_;
  bool sorted_ = false;
};

}  // namespace meshhier::partition
