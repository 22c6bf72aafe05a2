// Sorting in memory with all threads: quicksort (Hoare 1962) whose parts are tasks. What is
// parallel is compiled once; of a type of records only std::sort and the loop that splits them are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>

namespace meshhier::partition {

/// How to sort records that a driver knows by their places alone. Called from several threads at a
/// time, for ranges without a common record.
struct SortSteps {
  /// Sorts the records [begin, begin + count).
  std::function<void(std::size_t begin, std::size_t count)> sort;
  /// Puts 3 or more records [begin, begin + count) in two parts, none of the first after any of the
  /// second. Returns how many are in the first: 1 or more, less than `count`.
  std::function<std::size_t(std::size_t begin, std::size_t count)> split;
};

/// Sorts the records [0, count), in parallel on the caller's TBB arena. Takes n log n steps if
/// `sort` does.
void parallel_sort(std::size_t count, const SortSteps& steps);

/// As SortSteps::split, around the median of three records.
template <class Record, class Less>
std::size_t split_at_median(std::span<Record> records, const Less& less) {
  const Record &first = records.front(), &middle = records[records.size() / 2],
               &last = records.back();
  // Some other record is not less and some other is not greater: neither loop leaves the range.
  const Record pivot = std::max(std::min(first, middle, less),
                                std::min(std::max(first, middle, less), last, less), less);
  auto low = records.begin(), high = records.end() - 1;
  for (;; ++low, --high) {
    while (less(*low, pivot))
      ++low;
    while (less(pivot, *high))
      --high;
    if (low >= high)
      return static_cast<std::size_t>(high + 1 - records.begin());
    std::swap(*low, *high);
  }
}

/// Sorts records, which are copied freely, by the strict weak order `less`, which is called from
/// several threads. Needs no memory. Records that are equal to `less` come in any order.
template <class Record, class Less>
void parallel_sort(std::span<Record> records, const Less& less) {
  parallel_sort(records.size(), {[&](std::size_t begin, std::size_t count) {
                                   const auto part = records.subspan(begin, count);
                                   if (!std::is_sorted(part.begin(), part.end(), less))
                                     std::sort(part.begin(), part.end(), less);
                                 },
                                 [&](std::size_t begin, std::size_t count) {
                                   return split_at_median(records.subspan(begin, count), less);
                                 }});
}

}  // namespace meshhier::partition
