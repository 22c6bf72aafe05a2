// The texels that a side of a rectangle shows, where the picture goes on beyond itself.
#pragma once

#include "hierarchy/texture.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::images {

/// Returns the column, < side, that each of the columns first ... first + count - 1 shows. Any
/// `first`; side > 0.
std::vector<std::uint32_t> wrapped_run(std::int64_t first, std::uint32_t count, std::uint32_t side,
                                       Wrap wrap);

/// Neighbours of a run that lie in one block: run[begin] ... run[end - 1].
struct BlockRun {
  std::size_t begin = 0, end = 0;
  std::uint32_t block = 0;
};
std::vector<BlockRun> block_runs(const std::vector<std::uint32_t>& run);

}  // namespace meshhier::images
