#include "partition/parallel_sort.h"

#include <bit>

#include <tbb/global_control.h>
#include <tbb/task_group.h>

namespace meshhier::partition {
namespace {

/// Fewer records are sorted sooner than another thread is there to help.
constexpr std::size_t kLeastPart = 4096;
/// Parts of a thread at least: one waits for another an eighth of its time at most.
constexpr std::size_t kPartsPerThread = 8;

class Sorter {
 public:
  Sorter(std::size_t count, const SortSteps& steps) : steps_(steps) {
    const std::size_t threads =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    part_ = std::max(kLeastPart, count / (kPartsPerThread * threads));
    // As std::sort gives up on quicksort when it has split twice as often as halves would take.
    const int splits = 2 * static_cast<int>(std::bit_width(count));
    tasks_.run_and_wait([&] { sort(0, count, splits); });
  }

 private:
  /// Sorts the records [begin, begin + count), none of which are split more than `splits` times.
  void sort(std::size_t begin, std::size_t count, int splits) {
    while (count > part_ && splits > 0) {
      --splits;
      const std::size_t first = steps_.split(begin, count);
      tasks_.run([=, this] { sort(begin, first, splits); });
      begin += first;
      count -= first;
    }
    steps_.sort(begin, count);
  }

  const SortSteps& steps_;
  std::size_t part_;
  tbb::task_group tasks_;
};

}  // namespace

void parallel_sort(std::size_t count, const SortSteps& steps) {
  if (count > kLeastPart)
    Sorter(count, steps);
  else
    steps.sort(0, count);
}

}  // namespace meshhier::partition
