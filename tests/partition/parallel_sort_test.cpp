#include "partition/parallel_sort.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::partition {
namespace {

/// Records in an order that sorts may stumble over.
struct Arrival {
  const char* name;
  std::function<std::uint64_t(std::size_t i, std::size_t count)> record;
};

const std::vector<Arrival>& arrivals() {
  static const std::vector<Arrival> all = {
      {"random", [](std::size_t i, std::size_t) { return i * 6364136223846793005U >> 20; }},
      {"few values", [](std::size_t i, std::size_t) { return i * 6364136223846793005U >> 62; }},
      {"equal", [](std::size_t, std::size_t) { return 7; }},
      {"sorted", [](std::size_t i, std::size_t) { return i; }},
      {"reversed", [](std::size_t i, std::size_t count) { return count - i; }},
      {"sorted but the last", [](std::size_t i, std::size_t n) { return i + 1 == n ? 0 : i; }},
      {"up and down", [](std::size_t i, std::size_t count) { return std::min(i, count - i); }},
      {"saw teeth", [](std::size_t i, std::size_t) { return i % 1000; }}};
  return all;
}

TEST(ParallelSortTest, SortsWhateverComesWithAnyNumberOfThreads) {
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    for (const std::size_t count : {0U, 1U, 2U, 3U, 4096U, 4097U, 100'000U}) {
      for (const Arrival& arrival : arrivals()) {
        std::vector<std::uint64_t> records(count);
        for (std::size_t i = 0; i < count; ++i)
          records[i] = arrival.record(i, count);
        std::vector<std::uint64_t> expected = records;
        std::sort(expected.begin(), expected.end());
        parallel_sort(std::span(records), std::less());
        EXPECT_EQ(records, expected) << arrival.name << ", " << count << ", " << threads;
      }
    }
  }
}

/// Makes any quicksort slow: which record is greater is decided when it is asked, so that pivots
/// turn out to be among the least (McIlroy, A killer adversary for quicksort, 1999).
class Adversary {
 public:
  explicit Adversary(std::size_t count) : values_(count, kGas) {}

  bool less(std::size_t a, std::size_t b) {
    ++comparisons_;
    if (values_[a] == kGas && values_[b] == kGas)
      values_[a == candidate_ ? a : b] = solid_++;
    if (values_[a] == kGas)
      candidate_ = a;
    else if (values_[b] == kGas)
      candidate_ = b;
    return values_[a] < values_[b];
  }

  std::size_t comparisons() const { return comparisons_; }

 private:
  static constexpr std::size_t kGas = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> values_;
  std::size_t solid_ = 0, candidate_ = 0, comparisons_ = 0;
};

TEST(ParallelSortTest, TheWorstOrderTakesNoMoreThanNLogNComparisons) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<std::size_t> records(100'000);
  std::iota(records.begin(), records.end(), std::size_t{0});
  Adversary adversary(records.size());
  const auto less = [&](std::size_t a, std::size_t b) { return adversary.less(a, b); };
  parallel_sort(std::span(records), less);
  EXPECT_LT(adversary.comparisons(), 4 * records.size() * std::bit_width(records.size()));
  EXPECT_TRUE(std::is_sorted(records.begin(), records.end(), less));
}

TEST(ParallelSortTest, AFailureIsThrownAgain) {
  std::vector<int> records(100'000);
  std::iota(records.rbegin(), records.rend(), 0);
  const auto less = [](int a, int b) {
    if (a == 77'777 || b == 77'777)
      throw std::runtime_error("77777");
    return a < b;
  };
  EXPECT_THROW(parallel_sort(std::span(records), less), std::runtime_error);
}

/// All sequences of `count` numbers below `values`.
std::vector<std::vector<int>> sequences(std::size_t count, int values) {
  std::vector<std::vector<int>> all = {{}};
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::vector<int>> longer;
    for (const std::vector<int>& sequence : all) {
      for (int value = 0; value < values; ++value) {
        longer.push_back(sequence);
        longer.back().push_back(value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

TEST(SplitAtMedianTest, NoPartIsEmptyAndNoneOfTheFirstComesAfterTheSecond) {
  for (std::size_t count = 3; count <= 7; ++count) {
    for (const std::vector<int>& sequence : sequences(count, 4)) {
      std::vector<int> split = sequence;
      const std::size_t first = split_at_median(std::span(split), std::less());
      ASSERT_TRUE(0 < first && first < count) << testing::PrintToString(sequence);
      const auto second = split.begin() + static_cast<std::ptrdiff_t>(first);
      ASSERT_LE(*std::max_element(split.begin(), second), *std::min_element(second, split.end()))
          << testing::PrintToString(sequence);
      ASSERT_TRUE(std::is_permutation(split.begin(), split.end(), sequence.begin()))
          << testing::PrintToString(sequence);
    }
  }
}

}  // namespace
}  // namespace meshhier::partition
