// Bounded parallelism: serial in, parallel work, serial out in order. Results never depend on
// completion order. All run on the caller's TBB arena; what waits may do other work of it
// meanwhile.
#pragma once

#include "execution/cancel.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::execution {

/// How many blocks of `block_bytes` to have in flight within `memory_bytes`: one at least, and no
/// more than there are threads for.
std::size_t useful_blocks(std::uint64_t memory_bytes, std::uint64_t block_bytes);

/// Runs work(i) for all i in [0, count) in parallel, in any order. The first exception ends it and
/// is thrown again here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work);

/// Runs work(i) for all i in [0, count) in parallel, at most `in_flight` at a time, and sink(i) in
/// the order of i, one at a time, which returns whether to go on. Work on i is done, and its place
/// i % in_flight left, before i + in_flight is let in. If several fail, the exception of the least
/// i is thrown here; none of an i behind the one that ended it.
void ordered_steps(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                   const std::function<void(std::size_t)>& work,
                   const std::function<bool(std::size_t)>& sink);

/// The same of as many i as there are: read(i) says whether i is one, in the order of i, one at a
/// time; its failure comes behind the sinks of all i before.
void ordered_reads(std::size_t in_flight, const CancelToken& cancel,
                   const std::function<bool(std::size_t)>& read,
                   const std::function<void(std::size_t)>& work,
                   const std::function<bool(std::size_t)>& sink);

/// As ordered_steps; hands each result to sink(i, result).
template <class Work, class Sink>
void ordered_for(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                 const Work& work, const Sink& sink) {
  std::vector<std::optional<decltype(work(std::size_t{}))>> results(in_flight);
  ordered_steps(
      count, in_flight, cancel, [&](std::size_t i) { results[i % in_flight].emplace(work(i)); },
      [&](std::size_t i) {
        sink(i, *std::exchange(results[i % in_flight], std::nullopt));
        return true;
      });
}

/// As ordered_steps, for many small items: work(i, slot) leaves its result in one of `in_flight`
/// slots, whose memory is used again and again, and sink(slot) returns whether to go on.
template <class Slot, class Work, class Sink>
void ordered_blocks(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                    const Work& work, const Sink& sink) {
  std::vector<Slot> slots(in_flight);
  ordered_steps(
      count, in_flight, cancel, [&](std::size_t i) { work(i, slots[i % in_flight]); },
      [&](std::size_t i) { return sink(slots[i % in_flight]); });
}

/// As ordered_reads, for many small items, as ordered_blocks: read(slot) fills one of `in_flight`
/// slots or returns false.
template <class Slot, class Read, class Work, class Sink>
void ordered_read_blocks(std::size_t in_flight, const CancelToken& cancel, const Read& read,
                         const Work& work, const Sink& sink) {
  std::vector<Slot> slots(in_flight);
  ordered_reads(
      in_flight, cancel, [&](std::size_t i) { return read(slots[i % in_flight]); },
      [&](std::size_t i) { work(slots[i % in_flight]); },
      [&](std::size_t i) {
        sink(slots[i % in_flight]);
        return true;
      });
}

/// Parallel work on items that a visitor hands out one by one: gathers `batch` of them in slots,
/// works on all in parallel, and hands the slots to the sink in order. finish() does the rest.
template <class Slot>
class BatchedWork {
 public:
  BatchedWork(std::size_t batch, std::function<void(Slot&)> work, std::function<void(Slot&)> sink)
      : slots_(batch), work_(std::move(work)), sink_(std::move(sink)) {}

  /// The slot for the next item, as its last use left it. Fill it before the next call.
  Slot& next() {
    if (filled_ == slots_.size())
      finish();
    return slots_[filled_++];
  }

  void finish() {
    parallel_for(filled_, [&](std::size_t i) { work_(slots_[i]); });
    for (std::size_t i = 0; i < filled_; ++i)
      sink_(slots_[i]);
    filled_ = 0;
  }

 private:
  std::vector<Slot> slots_;
  std::size_t filled_ = 0;
  std::function<void(Slot&)> work_;
  std::function<void(Slot&)> sink_;
};

}  // namespace meshhier::execution
