// A mesh as one tile, for tests of what looks at a tile alone.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "tests/support/meshes.h"

#include <cstdint>

namespace meshhier::tests {

inline TileMesh one_tile(const TestMesh& mesh) {
  TileMesh tile;
  tile.vertices.positions = mesh.positions;
  tile.own_count = static_cast<std::uint32_t>(mesh.positions.size());
  for (const MeshTriangle& t : mesh.triangles)
    tile.interior.push_back({TileVertex{t[0]}, TileVertex{t[1]}, TileVertex{t[2]}});
  return tile;
}

}  // namespace meshhier::tests
