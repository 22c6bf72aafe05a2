// The order of a partition's vertices in its file.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <cstdint>
#include <vector>

namespace meshhier::pipeline {

/// Brings the own vertices behind the boundary into the order in which a GPU that draws the
/// interior triangles for its vertex cache first needs them: they are fetched, and packed, one
/// after another. No other tile names them: ghosts are on the boundary, and parent maps and chains
/// lead upwards. `parent_map`: one entry an own vertex, or empty; it is reordered, too. Returns the
/// new number of each place. Deterministic for one version of meshoptimizer.
std::vector<std::uint32_t> order_inner_vertices(TileMesh& mesh,
                                                std::vector<std::uint16_t>& parent_map);

}  // namespace meshhier::pipeline
