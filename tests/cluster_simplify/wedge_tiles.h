// Tiles whose places have several wedges, made of vertices as files list them.
#pragma once

#include "base/vec.h"
#include "hierarchy/build_tile.h"
#include "tests/support/meshes.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::tests {

/// Vertices with attributes; those of equal position are wedges of one place.
struct WedgeMesh {
  int channels = 0;
  std::vector<Vec3f> positions;
  std::vector<float> attributes;
  std::vector<MeshTriangle> triangles;

  /// Returns the new vertex.
  std::uint32_t add(Vec3f position, const std::vector<float>& vertex_attributes);
};

/// Returns the attributes that each corner of a triangle gets.
using CornerAttributes = std::function<std::vector<float>(std::uint32_t triangle, Vec3f position)>;

/// Each corner its own vertex.
WedgeMesh soup_of(const TestMesh& mesh, int channels, const CornerAttributes& attributes);

/// Vertices of equal position and attributes are one.
WedgeMesh welded(const WedgeMesh& mesh);

/// Places in the order of their first vertices; those with x > limit are ghosts.
BuildTile tile_of(const WedgeMesh& mesh, float limit = std::numeric_limits<float>::infinity());

/// The attributes of a wedge of any tile's place.
std::span<const float> wedge_of(const TileMesh& mesh, std::uint32_t place, std::uint32_t wedge);

}  // namespace meshhier::tests
