// Which vertices and splits the corners of a tile's triangles show.
#pragma once

#include "hierarchy/published.h"
#include "hierarchy/vertex_numbers.h"

#include <cstdint>
#include <vector>

namespace meshhier {

/// The interior triangles of a tile with the numbers that its Shading, and its file, have for their
/// corners. O(t log copies).
inline std::vector<TileTriangle> shown_interior(const PublishedTile& tile) {
  const TileMesh& mesh = tile.mesh;
  if (!tile.shading.split_of.empty())
    return tile.shading.interior;
  return VertexNumbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places)
      .numbered(mesh.interior, mesh.interior_wedges);
}

/// Likewise the border triangles.
inline std::vector<TileTriangle> shown_border(const PublishedTile& tile) {
  const TileMesh& mesh = tile.mesh;
  if (!tile.shading.split_of.empty())
    return tile.shading.border;
  return VertexNumbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places)
      .numbered(mesh.border, mesh.border_wedges);
}

}  // namespace meshhier
