#include "execution/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

namespace meshhier::execution {

std::size_t useful_blocks(std::uint64_t memory_bytes, std::uint64_t block_bytes) {
  const std::size_t threads =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::clamp<std::uint64_t>(memory_bytes / block_bytes, 1, 2 * threads);
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
  tbb::parallel_for(std::size_t{0}, count, work);
}

void ordered_reads(std::size_t in_flight, const CancelToken& cancel,
                   const std::function<bool(std::size_t)>& read,
                   const std::function<void(std::size_t)>& work,
                   const std::function<bool(std::size_t)>& sink) {
  // Only numbers are in TBB's tokens: TBB 2021.8 forgets to destroy some tokens when an exception
  // ends the pipeline.
  std::vector<std::exception_ptr> failures(in_flight);
  std::size_t next = 0;
  bool has_failed = false;  // to read
  std::atomic<bool> ended = false;
  const auto start = [&](tbb::flow_control& control) {
    const auto is_there = [&] {
      try {
        return read(next);
      } catch (...) {
        failures[next % in_flight] = std::current_exception();
        has_failed = true;
        return true;
      }
    };
    const bool is_over = ended || has_failed;
    if (!is_over)
      cancel.check();
    if (is_over || !is_there()) {
      control.stop();
      return next;
    }
    return next++;
  };
  const auto run = [&](std::size_t i) {
    if (failures[i % in_flight])
      return i;
    try {
      work(i);
    } catch (...) {
      failures[i % in_flight] = std::current_exception();
    }
    return i;
  };
  const auto end = [&](std::size_t i) {
    if (ended)
      return;
    if (const std::exception_ptr& failure = failures[i % in_flight])
      std::rethrow_exception(failure);
    ended = !sink(i);
  };
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      in_flight, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, start) &
                     tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, run) &
                     tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, end));
}

void ordered_steps(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                   const std::function<void(std::size_t)>& work,
                   const std::function<bool(std::size_t)>& sink) {
  ordered_reads(
      in_flight, cancel, [&](std::size_t i) { return i < count; }, work, sink);
}

}  // namespace meshhier::execution
