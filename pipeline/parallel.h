// Bounded parallelism: serial in, parallel work, serial out in order. Results never depend on
// completion order.
#pragma once

#include "pipeline/cancel.h"

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

namespace meshhier::pipeline {

/// Runs work(i) for all i in [0, count) in parallel, at most `in_flight` at a time, and hands each
/// result to sink(i, result) in the order of i, one at a time. The first exception ends it and is
/// thrown again here.
template <class Work, class Sink>
void ordered_for(std::size_t count, std::size_t in_flight, const CancelToken& cancel,
                 const Work& work, const Sink& sink) {
  using Result = decltype(work(std::size_t{}));
  using Item = std::pair<std::size_t, Result>;
  std::size_t next = 0;
  tbb::parallel_pipeline(
      in_flight,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                          [&](tbb::flow_control& control) {
                                            if (next == count) {
                                              control.stop();
                                              return count;
                                            }
                                            cancel.check();
                                            return next++;
                                          }) &
          tbb::make_filter<std::size_t, Item>(tbb::filter_mode::parallel,
                                              [&](std::size_t i) { return Item(i, work(i)); }) &
          tbb::make_filter<Item, void>(tbb::filter_mode::serial_in_order, [&](Item item) {
            sink(item.first, std::move(item.second));
          }));
}

/// Parallel work on items that a visitor hands out one by one: gathers `batch` of them, works on
/// all in parallel, and hands the results to the sink in order. finish() does the rest.
template <class Item, class Result>
class BatchedWork {
 public:
  BatchedWork(std::size_t batch, std::function<Result(const Item&)> work,
              std::function<void(Result&)> sink)
      : batch_(batch), work_(std::move(work)), sink_(std::move(sink)) {}

  void add(Item item) {
    items_.push_back(std::move(item));
    if (items_.size() == batch_)
      finish();
  }

  void finish() {
    std::vector<Result> results(items_.size());
    tbb::parallel_for(std::size_t{0}, items_.size(),
                      [&](std::size_t i) { results[i] = work_(items_[i]); });
    items_.clear();
    for (Result& result : results)
      sink_(result);
  }

 private:
  std::size_t batch_;
  std::function<Result(const Item&)> work_;
  std::function<void(Result&)> sink_;
  std::vector<Item> items_;
};

}  // namespace meshhier::pipeline
