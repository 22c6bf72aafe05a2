// Points along a space-filling curve: near each other in number, near each other in space.
#pragma once

#include "base/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// The indices of `positions` in the order of a Morton curve of 1024^3 cells over their bounding
/// box; within a cell as they came. Non-finite coordinates lie in any cell. O(n), a radix sort.
std::vector<std::uint32_t> spatial_order(std::span<const Vec3f> positions);

}  // namespace meshhier::partition
