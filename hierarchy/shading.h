// Shading: what a build adds to the vertices of tiles. Normals for a mesh that has none,
// coordinates in the tile's own picture for a mesh with textures, coordinates and tangents for a
// normal map.
//
// They are kept apart from the tile's mesh: at a crease a vertex has several normals, at the border
// of a chart several coordinates, and who asks for the mesh (verify --input, export, streams) gets
// it as if there were none. The vertex itself has the first of them; for each further one it is
// split.
#pragma once

#include "hierarchy/normal_code.h"
#include "hierarchy/tangent_code.h"
#include "hierarchy/texture.h"
#include "hierarchy/tile_mesh.h"

#include <cstdint>
#include <vector>

namespace meshhier {

/// The shading of a tile. Vertices have the numbers of VertexNumbers, [0, n): places, then copies.
/// Split i has the number n + i.
struct Shading {
  std::vector<NormalCode> normals;  ///< of vertices, then of splits; empty: no computed normals
  std::vector<Vec2f> texcoords;  ///< likewise, in the tile's picture or normal map; empty: it has
                                 ///< neither
  std::vector<std::uint32_t> split_of;  ///< of each split its vertex, < n; ascending
  /// The triangles of the mesh, one for one and corner for corner, with numbers of vertices and
  /// splits. Empty if there are no splits: each corner has the normal of its vertex then.
  std::vector<TileTriangle> interior, border;
  std::vector<TangentCode> tangents{};  ///< as `texcoords`, for the normal map; empty: it has none

  bool empty() const { return normals.empty() && texcoords.empty(); }
  friend bool operator==(const Shading&, const Shading&) = default;
};

/// A tile of so many triangles has no more splits: each is at a corner.
constexpr std::uint64_t most_splits(std::uint64_t interior_count, std::uint64_t border_count) {
  return 3 * (interior_count + border_count);
}

/// The shading of a tile's own vertices: places, then their copies.
struct OwnShading {
  std::vector<NormalCode> normals;      ///< of own places, of their copies, of splits
  std::vector<std::uint32_t> split_of;  ///< number of an own place, or own_count + copy; ascending
};

/// The part of it that a tile shows its neighbours: its boundary. Numbers are those of the
/// boundary: place v has the number v, copy i the number boundary_count + i.
struct BoundaryShading {
  std::uint32_t boundary_count = 0;
  std::vector<std::uint32_t> copy_places;  ///< of the copies on the boundary, ascending
  OwnShading shading;
};

}  // namespace meshhier
