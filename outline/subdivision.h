// Sectors within a tile: its vertices, cut at medians again and again, by where they lie or by
// where the surface faces. The second makes lines along limbs and edges, where the first makes
// rings.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <cstdint>
#include <vector>

namespace meshhier::outline {

/// The part of each own vertex: below `parts`, which is 1 to 65536. Parts have equal counts, but
/// for vertices that all of their neighbours make change sides, so that lines are even.
/// Deterministic, O(t + n log n) for t triangles.
std::vector<std::uint16_t> divide(const TileMesh& tile, std::uint32_t parts);

}  // namespace meshhier::outline
