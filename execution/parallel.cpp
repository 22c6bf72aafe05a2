#include "execution/parallel.h"

#include "execution/serial_time.h"

#include <algorithm>
#include <atomic>
#include <exception>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

namespace meshhier::execution {

namespace {

std::size_t threads() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

}  // namespace

std::size_t useful_blocks(std::uint64_t memory_bytes, std::uint64_t block_bytes) {
  return std::clamp<std::uint64_t>(memory_bytes / block_bytes, 1, 2 * threads());
}

std::size_t with_those_that_wait(std::size_t in_flight) {
  return in_flight < threads() ? in_flight : std::max(in_flight, 3 * threads());
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
  ParallelCall call;
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t i) { call.work.count_longest([&] { work(i); }); });
}

namespace {

/// Items on their way through the steps of a pipeline. A failure ends it when all items before are
/// through, so that of several the first in order is thrown.
class Pipeline {
 public:
  Pipeline(std::size_t in_flight, const CancelToken& cancel, const OrderedSteps& steps)
      : steps_(steps), cancel_(cancel), items_(in_flight) {}

  void run() {
    // Only numbers are in TBB's tokens: TBB 2021.8 forgets to destroy some tokens when an exception
    // ends the pipeline.
    using tbb::filter_mode;
    using Number = std::size_t;
    auto filters =
        tbb::make_filter<void, Number>(filter_mode::serial_in_order,
                                       [&](tbb::flow_control& control) { return read(control); }) &
        tbb::make_filter<Number, Number>(filter_mode::parallel, [&](Number i) { return work(i); }) &
        tbb::make_filter<Number, Number>(filter_mode::serial_in_order,
                                         [&](Number i) { return sink(i); });
    if (steps_.after) {
      filters = filters & tbb::make_filter<Number, Number>(filter_mode::parallel,
                                                           [&](Number i) { return after(i); });
    }
    tbb::parallel_pipeline(items_.size(),
                           filters & tbb::make_filter<Number, void>(filter_mode::serial_in_order,
                                                                    [&](Number i) { end(i); }));
  }

 private:
  struct Item {
    std::exception_ptr failure;
    bool is_sunk = false;
  };
  Item& item(std::size_t i) { return items_[i % items_.size()]; }

  /// Runs a step of an item; returns whether it did not fail.
  template <class Step>
  static bool succeeds(Item& item, const Step& step) {
    try {
      step();
      return true;
    } catch (...) {
      item.failure = std::current_exception();
      return false;
    }
  }

  std::size_t read(tbb::flow_control& control) {
    const bool is_over = ended_ || has_failed_to_read_;
    if (!is_over)
      cancel_.check();
    if (is_over || !is_there()) {
      control.stop();
      return next_;
    }
    return next_++;
  }

  /// Whether there is a next item. One that fails to be read is an item with a failure.
  bool is_there() {
    bool is_there = true;
    has_failed_to_read_ =
        !succeeds(item(next_), [&] { call_.reads.count([&] { is_there = steps_.read(next_); }); });
    return is_there;
  }

  std::size_t work(std::size_t i) {
    if (!item(i).failure)
      succeeds(item(i), [&] { call_.work.count_longest([&] { steps_.work(i); }); });
    return i;
  }

  std::size_t sink(std::size_t i) {
    Item& sunk = item(i);
    sunk.is_sunk = false;
    if (ended_) {
      sunk.failure = nullptr;
    } else if (sunk.failure) {
      ended_ = true;
    } else {
      bool goes_on = false;
      sunk.is_sunk = succeeds(sunk, [&] { call_.sinks.count([&] { goes_on = steps_.sink(i); }); });
      ended_ = !goes_on;
    }
    return i;
  }

  std::size_t after(std::size_t i) {
    if (item(i).is_sunk)
      succeeds(item(i), [&] { call_.work.count_longest([&] { steps_.after(i); }); });
    return i;
  }

  void end(std::size_t i) {
    if (item(i).failure)
      std::rethrow_exception(item(i).failure);
  }

  const OrderedSteps& steps_;
  const CancelToken& cancel_;
  ParallelCall call_;
  std::vector<Item> items_;
  std::size_t next_ = 0;
  bool has_failed_to_read_ = false;
  std::atomic<bool> ended_ = false;
};

}  // namespace

void ordered_steps(std::size_t in_flight, const CancelToken& cancel, const OrderedSteps& steps) {
  Pipeline(in_flight, cancel, steps).run();
}

}  // namespace meshhier::execution
