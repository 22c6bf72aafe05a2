#include "images/block_grid.h"

#include <cstdint>

namespace meshhier::images {

std::uint32_t BlockGrid::first_strip(std::uint32_t level) const {
  std::uint32_t strips = 0;
  for (std::uint32_t i = 0; i < level; ++i)
    strips += (size(i).height + kBlockSide - 1) / kBlockSide;
  return strips;
}

}  // namespace meshhier::images
