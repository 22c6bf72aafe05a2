// Where attributes break: borders of charts, creases, borders of colours.
#pragma once

#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attributes.h"
#include "hierarchy/build_tile.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::cluster_simplify {

/// An edge between two own places, the lower first.
using PlaceEdge = std::array<std::uint32_t, 2>;

/// The edges between own places at which two triangles have, at either end, different texture
/// coordinates, other labels, or normals or colours that `options` keep apart, and label_borders();
/// ascending. O(t log t).
std::vector<PlaceEdge> attribute_seams(const BuildTile& joined, const AttributeLayout& layout,
                                       const WedgeOptions& options);

}  // namespace meshhier::cluster_simplify
