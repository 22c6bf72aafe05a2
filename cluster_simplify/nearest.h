// Nearest neighbours among points.
#pragma once

#include "hierarchy/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// For each of `asked` the nearest of `candidates` (at least one), both indices into `positions`.
/// Deterministic; among equally near ones any, but always the same. O(n log n).
std::vector<std::uint32_t> nearest_of(std::span<const Vec3f> positions,
                                      std::span<const std::uint32_t> candidates,
                                      std::span<const std::uint32_t> asked);

}  // namespace meshhier::cluster_simplify
