// How far the farthest sample of each run lies: what is behind it need not be drawn sample by
// sample (after Greene, Kass & Miller, Hierarchical z-buffer visibility, 1993).
#pragma once

#include "render/coverage.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace meshhier::render {

/// The farthest depth of each run of samples, of a grid whose depths only become less. It is never
/// nearer than the run's farthest sample, and maybe farther, as it is looked up now and then only.
/// 8 bytes a run.
class RunDepths {
 public:
  RunDepths(std::uint32_t columns, std::uint32_t rows)
      : columns_(columns),
        row_runs_((columns + kRunSamples - 1) / kRunSamples),
        runs_(static_cast<std::size_t>(row_runs_) * rows) {}

  /// Whether all that is at `depth` or behind it is hidden in a run of a row. `depth_of(i)`: of
  /// sample i, row by row.
  template <class DepthOf>
  bool hides(std::int64_t run, std::int64_t row, float depth, const DepthOf& depth_of) {
    Run& known = runs_[static_cast<std::size_t>(row * row_runs_ + run)];
    if (known.farthest > depth && ++known.asked == kRenewed) {
      known.asked = 0;
      known.farthest = farthest(run, row, depth_of);
    }
    return known.farthest <= depth;
  }

 private:
  /// A look at a whole run costs a few of its samples' drawing then.
  static constexpr std::uint32_t kRenewed = 16;

  struct Run {
    float farthest = std::numeric_limits<float>::infinity();
    std::uint32_t asked = 0;  ///< since it was looked up
  };

  template <class DepthOf>
  float farthest(std::int64_t run, std::int64_t row, const DepthOf& depth_of) const {
    const std::int64_t begin = run * kRunSamples, end = std::min(begin + kRunSamples, columns_);
    float most = -std::numeric_limits<float>::infinity();
    for (std::int64_t column = begin; column < end; ++column)
      most = std::max(most, depth_of(static_cast<std::size_t>(row * columns_ + column)));
    return most;
  }

  std::int64_t columns_, row_runs_;
  std::vector<Run> runs_;
};

}  // namespace meshhier::render
