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

void clamp_run(std::int64_t first, std::uint32_t side, std::vector<std::uint32_t>& run) {
  const std::uint64_t left = below_zero(first);
  const std::uint64_t right = first < 0 ? 0 : static_cast<std::uint64_t>(first);
  for (std::uint64_t i = 0; i < run.size(); ++i) {
    const std::uint64_t place = i < left ? 0 : right + (i - left);
    run[i] = static_cast<std::uint32_t>(std::min<std::uint64_t>(place, side - 1));
  }
}

/// The second half of a period that is longer than the side is the first one mirrored.
void repeat_run(std::int64_t first, std::uint32_t side, std::uint64_t period,
                std::vector<std::uint32_t>& run) {
  std::uint64_t place = floor_modulo(first, static_cast<std::int64_t>(period));
  for (std::uint32_t& at : run) {
    at = static_cast<std::uint32_t>(place < side ? place : period - 1 - place);
    if (++place == period)
      place = 0;
  }
}

}  // namespace

std::vector<std::uint32_t> wrapped_run(std::int64_t first, std::uint32_t count, std::uint32_t side,
                                       Wrap wrap) {
  std::vector<std::uint32_t> run(count);
  if (wrap == Wrap::clamp)
    clamp_run(first, side, run);
  else
    repeat_run(first, side, wrap == Wrap::mirrored ? std::uint64_t{2} * side : side, run);
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
