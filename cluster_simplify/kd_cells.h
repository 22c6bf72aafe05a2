// Cells of equal vertex count by kd median splits.
#pragma once

#include "base/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Cuts points into `cell_count` cells, split at medians along the longest axis of each box; sizes
/// differ by at most one, ties go by index. Returns each point's cell; cells are numbered in kd
/// order. Requires 1 <= cell_count <= points.size(). O(n log n), deterministic.
std::vector<std::uint32_t> kd_cells(std::span<const Vec3f> points, std::uint32_t cell_count);

}  // namespace meshhier::cluster_simplify
