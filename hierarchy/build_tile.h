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

/// What a simplified tile shows of itself to those who measure beside it: its border triangles as
/// they were when it was made, foreign corners where they had been one level finer, and the
/// interior triangles at its rim.
struct Band {
  std::uint32_t rim_count = 0;
  std::uint32_t own_count = 0;     ///< own vertices in the band, rim first
  std::vector<Vec3f> positions;    ///< own, then foreign
  std::vector<float> drifts;       ///< of own ones: what the triangles around them may have moved
  std::vector<GhostRef> foreign;   ///< as WorkTile::foreign
  std::vector<Triangle> interior;  ///< with a corner in the rim
  std::vector<Triangle> border;
  float interior_drift = 0;  ///< the largest of all interior triangles of the tile
  float lost = 0;            ///< see cluster_simplify::Drift
  double squared_sum = 0;    ///< likewise
  double weight_sum = 0;     ///< of own vertices
};

}  // namespace meshhier
