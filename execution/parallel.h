// Bounded parallelism: serial in, parallel work, serial out in order. Results never depend on
// completion order.
#pragma once

#include "execution/cancel.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

namespace meshhier::execution {

/// How many blocks of `block_bytes` to have in flight within `memory_bytes`: one at least, and no
/// more than there are threads for.
inline std::size_t useful_blocks(std::uint64_t memory_bytes, std::uint64_t block_bytes) {
  const std::size_t threads =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::clamp<std::uint64_t>(memory_bytes / block_bytes, 1, 2 * threads);
}

/// Runs work(i) for all i in [0, count) in parallel, at most `in_flight` at a time, and hands each
/// result to sink(i, result) in the order of i, one at a time. The first exception ends it and is
/// thrown again here.
template <class Work, class Sink>
void ordered_for(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                 const Work& work, const Sink& sink) {
  using Result = decltype(work(std::size_t{}));
  // Results wait here, not in TBB's tokens: TBB 2021.8 forgets to destroy some when an exception
  // ends it. They leave in order, so that the place of i is free when i + in_flight is let in.
  std::vector<std::optional<Result>> results(in_flight);
  std::size_t next = 0;
  const auto start = [&](tbb::flow_control& control) {
    if (next == count) {
      control.stop();
      return count;
    }
    cancel.check();
    return next++;
  };
  const auto run = [&](std::size_t i) {
    results[i % in_flight].emplace(work(i));
    return i;
  };
  const auto end = [&](std::size_t i) {
    std::optional<Result>& place = results[i % in_flight];
    Result result = std::move(*place);
    place.reset();
    sink(i, std::move(result));
  };
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      in_flight, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, start) &
                     tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, run) &
                     tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, end));
}

/// As ordered_for, for many small items: work(i, slot) leaves its result in one of `in_flight`
/// slots, whose memory is used again and again, and sink(slot) returns whether to go on. If several
/// fail, the exception of the least i is thrown; none of an i behind the one that ended it.
template <class Slot, class Work, class Sink>
void ordered_blocks(std::uint64_t count, std::size_t in_flight, const CancelToken& cancel,
                    const Work& work, const Sink& sink) {
  struct Item {
    Slot slot;
    std::exception_ptr failure;
  };
  // Items leave in order, so that of item i is free again when i + in_flight is let in.
  std::vector<Item> items(in_flight);
  std::uint64_t next = 0;
  std::atomic<bool> ended = false;
  const auto start = [&](tbb::flow_control& control) {
    if (next == count || ended) {
      control.stop();
      return count;
    }
    cancel.check();
    return next++;
  };
  const auto run = [&](std::uint64_t i) {
    Item& item = items[i % in_flight];
    try {
      work(i, item.slot);
    } catch (...) {
      item.failure = std::current_exception();
    }
    return i;
  };
  const auto end = [&](std::uint64_t i) {
    Item& item = items[i % in_flight];
    if (ended)
      return;
    if (item.failure)
      std::rethrow_exception(item.failure);
    ended = !sink(item.slot);
  };
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      in_flight, tbb::make_filter<void, std::uint64_t>(filter_mode::serial_in_order, start) &
                     tbb::make_filter<std::uint64_t, std::uint64_t>(filter_mode::parallel, run) &
                     tbb::make_filter<std::uint64_t, void>(filter_mode::serial_in_order, end));
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
    tbb::parallel_for(std::size_t{0}, filled_, [&](std::size_t i) { work_(slots_[i]); });
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
