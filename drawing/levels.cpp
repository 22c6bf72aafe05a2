#include "drawing/levels.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::drawing {

CutLevels::CutLevels(std::vector<double> heights) {
  std::ranges::sort(heights);
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  for (const double height : heights)
    levels_.push_back({height + 0.0});  // -0 is 0
}

CutLevels CutLevels::contours(double interval, double low, double high) {
  constexpr std::int64_t kIndexStep = 5;
  constexpr double kMostSteps = 1e15;  // each is a number of its own
  const double first = std::floor(low / interval), last = std::ceil(high / interval);
  if (!(last - first <= kMostLevels) || !(std::max(std::abs(first), std::abs(last)) < kMostSteps)) {
    throw Error(
        ErrorCode::usage,
        fmt::format("--contours {} would be {:.3g} heights, from {:.6g} to {:.6g}; there may be "
                    "{}: give {:.2g} or more",
                    interval, last - first, low, high, kMostLevels,
                    std::max(1.1 * (high - low) / kMostLevels,
                             std::max(std::abs(low), std::abs(high)) / kMostSteps)));
  }
  CutLevels levels;
  for (auto step = static_cast<std::int64_t>(first); step <= static_cast<std::int64_t>(last);
       ++step) {
    const double height = static_cast<double>(step) * interval;
    if (height > low && height <= high)
      levels.levels_.push_back({height, step % kIndexStep == 0});
  }
  return levels;
}

LevelRange CutLevels::between(double low, double high) const {
  const auto first_above = [&](double height) {
    const auto found = std::ranges::upper_bound(levels_, height, {}, &CutLevel::height);
    return static_cast<std::uint32_t>(found - levels_.begin());
  };
  return {first_above(low), first_above(high)};
}

}  // namespace meshhier::drawing
