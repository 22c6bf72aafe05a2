// Sums over many tiles, from which the bytes that they take follow: expected ones before a build,
// or counted ones.
#pragma once

namespace meshhier::storage {

struct TileSums {
  double count = 0;                 ///< tiles
  double vertices = 0;              ///< own places
  double copies = 0;                ///< further vertices at own places
  double boundary = 0;              ///< own vertices that are in the boundary
  double triangles = 0;             ///< border ones once in each tile they touch
  double wide_triangles = 0;        ///< those among them whose corners take 32 bits
  double foreign_per_boundary = 0;  ///< WorkTile::foreign, per vertex of the boundary
  double ghosts_per_boundary = 0;   ///< ghosts of published tiles, per vertex of the boundary

  double copies_per_vertex() const { return vertices > 0 ? copies / vertices : 0; }
};

}  // namespace meshhier::storage
