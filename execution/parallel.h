// Bounded parallelism: serial in, parallel work, serial out in order. Results never depend on
// completion order. All run on the caller's TBB arena; a thread that waits may do other work of it
// meanwhile, so a caller must hold no lock that any of it takes. Each call returns, or throws, when
// all of its own work has ended.
#pragma once

#include "execution/cancel.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::execution {

/// Returns how many blocks of `block_bytes` to have in flight within `memory_bytes`: one at least,
/// and no more than twice the threads.
std::size_t useful_blocks(std::uint64_t memory_bytes, std::uint64_t block_bytes);

/// Returns how many items to let in where there is memory for so many, if they hold it only while
/// they are at work: no more are than there are threads, others wait for those before them.
std::size_t with_those_that_wait(std::size_t in_flight);

/// Runs work(i) for all i in [0, count) in parallel, in any order. The first exception ends it and
/// is thrown again here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work);

/// The steps of the items 0, 1, 2, ...
struct OrderedSteps {
  std::function<bool(std::size_t)> read;     ///< whether there is such an item; in order
  std::function<void(std::size_t)> work;     ///< in parallel
  std::function<bool(std::size_t)> sink;     ///< whether to go on; in order
  std::function<void(std::size_t)> after{};  ///< in parallel, if it was sunk; may be none
};

/// Runs the steps of all items, one after the other for each, at most `in_flight` items at a time.
/// Those in order run one at a time. All is done with i, and its place i % in_flight left, before
/// i + in_flight is read. If several fail, the exception of the least i is thrown here, behind the
/// sinks of all i before; none of an i behind the one that ended it. Throws Error(interrupted) once
/// cancelled.
void ordered_steps(std::size_t in_flight, const CancelToken& cancel, const OrderedSteps& steps);

/// Runs work(i) for all i in [0, count) and gives each result to sink(i, result), by
/// ordered_steps().
template <class Work, class Sink>
void ordered_for(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                 const Work& work, const Sink& sink) {
  std::vector<std::optional<decltype(work(std::size_t{}))>> results(in_flight);
  ordered_steps(in_flight, cancel,
                {[&](std::size_t i) { return i < count; },
                 [&](std::size_t i) { results[i % in_flight].emplace(work(i)); },
                 [&](std::size_t i) {
                   sink(i, *std::exchange(results[i % in_flight], std::nullopt));
                   return true;
                 }});
}

/// Does what ordered_for() does, for many small items: work(i, slot) leaves its result in one of
/// `in_flight` slots, whose memory is used again and again, sink(slot) returns whether to go on,
/// and after(slot) may follow it in parallel.
template <class Slot, class Work, class Sink>
void ordered_blocks(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                    const Work& work, const Sink& sink,
                    const std::function<void(Slot&)>& after = {}) {
  std::vector<Slot> slots(in_flight);
  OrderedSteps steps{[&](std::size_t i) { return i < count; },
                     [&](std::size_t i) { work(i, slots[i % in_flight]); },
                     [&](std::size_t i) { return sink(slots[i % in_flight]); }};
  if (after)
    steps.after = [&](std::size_t i) { after(slots[i % in_flight]); };
  ordered_steps(in_flight, cancel, steps);
}

/// Does what ordered_blocks() does, for as many items as there are: read(slot), in order, fills a
/// slot or returns false; its failure comes behind the sinks of all items before.
template <class Slot, class Read, class Work, class Sink>
void ordered_read_blocks(std::size_t in_flight, const CancelToken& cancel, const Read& read,
                         const Work& work, const Sink& sink) {
  std::vector<Slot> slots(in_flight);
  ordered_steps(in_flight, cancel,
                {[&](std::size_t i) { return read(slots[i % in_flight]); },
                 [&](std::size_t i) { work(slots[i % in_flight]); },
                 [&](std::size_t i) {
                   sink(slots[i % in_flight]);
                   return true;
                 }});
}

/// Parallel work on items that a visitor hands out one by one: gathers `batch` of them in slots,
/// works on all in parallel, hands the slots to the sink in order, and runs after() on all in
/// parallel, if there is one. finish() does the rest. next() and finish() are for one thread, and
/// throw what the steps throw.
template <class Slot>
class BatchedWork {
 public:
  using Step = std::function<void(Slot&)>;
  BatchedWork(std::size_t batch, Step work, Step sink, Step after = {})
      : slots_(batch), work_(std::move(work)), sink_(std::move(sink)), after_(std::move(after)) {}

  /// Returns the slot for the next item, as its last use left it. Fill it before the next call.
  Slot& next() {
    if (filled_ == slots_.size())
      finish();
    return slots_[filled_++];
  }

  void finish() {
    parallel_for(filled_, [&](std::size_t i) { work_(slots_[i]); });
    for (std::size_t i = 0; i < filled_; ++i)
      sink_(slots_[i]);
    if (after_)
      parallel_for(filled_, [&](std::size_t i) { after_(slots_[i]); });
    filled_ = 0;
  }

 private:
  std::vector<Slot> slots_;
  std::size_t filled_ = 0;
  Step work_, sink_, after_;
};

}  // namespace meshhier::execution
