// Where labels of vertices change.
#pragma once

#include "cluster_simplify/attribute_seams.h"
#include "cluster_simplify/tile_wedges.h"
#include "hierarchy/attributes.h"

#include <vector>

namespace meshhier::cluster_simplify {

/// The edges between own places that run beside a border of labels: of triangles that have one
/// label at two corners and another at the third, the edge between the two. Held on both sides,
/// they hold the border between them. Ascending, without repeats. O(t log t).
std::vector<PlaceEdge> label_borders(const TileWedges& wedges, const AttributeLayout& layout);

}  // namespace meshhier::cluster_simplify
