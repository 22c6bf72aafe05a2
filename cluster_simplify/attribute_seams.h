// Where attributes break: borders of charts, creases, borders of colours.
#pragma once

#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attribute_rules.h"
#include "hierarchy/build_tile.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::cluster_simplify {

class TileWedges;

/// An edge between two own places, the lower first.
using PlaceEdge = std::array<std::uint32_t, 2>;

/// The edges between own places at which two triangles have, at either end, different texture
/// coordinates, other labels, or normals or colours that `options` keep apart, and label_borders();
/// ascending. O(t log t).
std::vector<PlaceEdge> attribute_seams(const BuildTile& joined, const AttributeRules& rules,
                                       const WedgeOptions& options);

/// The edges between own places that run beside a border of labels: of triangles that have one
/// label at two corners and another at the third, the edge between the two. Held on both sides,
/// they hold the border between them. Ascending, without repeats. O(t log t).
std::vector<PlaceEdge> label_borders(const TileWedges& wedges, const AttributeRules& rules);

}  // namespace meshhier::cluster_simplify
