#include "images/wrapped_run.h"

#include "images/block_grid.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::images {
namespace {

/// The least number >= 0 that differs from `x` by a multiple of `period`.
std::uint64_t floor_modulo(std::int64_t x, std::int64_t period) {
  const std::int64_t rest = x % period;
  return static_cast<std::uint64_t>(rest < 0 ? rest + period : rest);
}

/// Returns how far left of 0 a column is.
std::uint64_t below_zero(std::int64_t x) {
  return x < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(x) : 0;
}

}  // namespace

std::vector<std::uint32_t> wrapped_run(std::int64_t first, std::uint32_t count, std::uint32_t side,
                                       Wrap wrap) {
  std::vector<std::uint32_t> run(count);
  const std::uint64_t period = wrap == Wrap::mirrored ? std::uint64_t{2} * side : side;
  const std::uint64_t start = floor_modulo(first, static_cast<std::int64_t>(period));
  const std::uint64_t left = below_zero(first);
  const std::uint64_t right = first < 0 ? 0 : static_cast<std::uint64_t>(first);
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t place = 0;
    if (wrap == Wrap::clamp) {
      place = i < left ? 0 : std::min<std::uint64_t>(right + (i - left), side - 1);
    } else {
      place = (start + i) % period;
      place = place < side ? place : period - 1 - place;
    }
    run[i] = static_cast<std::uint32_t>(place);
  }
  return run;
}

std::vector<BlockRun> block_runs(const std::vector<std::uint32_t>& run) {
  std::vector<BlockRun> runs;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const std::uint32_t block = run[i] / BlockGrid::kBlockSide;
    if (runs.empty() || runs.back().block != block)
      runs.push_back({i, i, block});
    runs.back().end = i + 1;
  }
  return runs;
}

}  // namespace meshhier::images
