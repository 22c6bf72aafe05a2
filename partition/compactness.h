// How compact a partition is.
#pragma once

#include "hierarchy/tile_mesh.h"

namespace meshhier::partition {

/// c = p^2 / (4 pi w) of a partition's tile: p its perimeter, the lines along which border
/// triangles are cut between their corners' partitions (edge midpoints to centroid); w its area,
/// every triangle's shared equally by its corners. 1 for a disc, larger for ragged or elongated
/// partitions (Kim & Lee); 0 if there is no area. Requires filled ghosts. Pure; O(t).
double compactness(const TileMesh& tile);

/// As the index has it: the largest float if it is larger.
float published_compactness(const TileMesh& tile);

}  // namespace meshhier::partition
