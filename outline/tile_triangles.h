// All triangles of a tile.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <vector>

namespace meshhier::outline {

/// Calls visit(triangle) for the interior and the border triangles.
template <class Visit>
void for_each_triangle(const TileMesh& tile, const Visit& visit) {
  for (const std::vector<TileTriangle>* triangles : {&tile.interior, &tile.border}) {
    for (const TileTriangle& t : *triangles)
      visit(t);
  }
}

}  // namespace meshhier::outline
