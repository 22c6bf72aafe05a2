// Tiles while a hierarchy is being built.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <cstdint>
#include <vector>

namespace meshhier {

/// What a build knows of a tile's own vertices beside their positions, one entry each.
struct VertexHistory {
  std::vector<float> weights;  ///< how many original vertices it stands for, >= 1
};

/// A tile just made: its border triangles still name their foreign corners as they were one step
/// earlier, because the neighbours' own maps were not known yet. `foreign` of a simplified tile
/// counts in tiles and vertices one level finer; of a partition, in chunks (partition/chunk.h) and
/// provisional ranks within the chunk.
struct WorkTile {
  VertexArray vertices;   ///< own only, rim first
  VertexHistory history;  ///< own only
  std::uint32_t rim_count = 0;
  std::vector<Triangle> interior;
  std::vector<Triangle>
      border;  ///< corners from vertices.size() on: foreign[corner - vertices.size()]
  std::vector<GhostRef> foreign;  ///< ascending, without repeats
};

/// What a tile shows of itself to its neighbours: its rim vertices, [0, rim_count).
struct Rim {
  VertexArray vertices;
};

/// A tile whose ghosts are known at its own level, with what contraction needs of them.
struct BuildTile {
  TileMesh mesh;
  VertexHistory history;  ///< own
};

/// What a tile shows of itself to those who measure beside it: its border triangles and two rows of
/// interior ones along them.
struct Band {
  std::vector<GhostRef> vertices;   ///< own ones, ascending, then ghosts, ascending
  std::vector<Vec3f> positions;     ///< one per entry of `vertices`
  std::vector<Triangle> triangles;  ///< corners are places in `vertices`
};

}  // namespace meshhier
