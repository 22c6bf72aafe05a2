// The normals of tiles under construction, as their files will have them.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/shading.h"
#include "hierarchy/tile_mesh.h"
#include "pipeline/tiles/forest.h"
#include "texture/normal_bake.h"

#include <cstdint>
#include <vector>

namespace meshhier::pipeline {

/// Returns the computed normals of a tile, whose vertices are as Forest::load() gives them; empty
/// if the build computes none.
Shading computed_shading(const Forest& forest, NodeId node, const TileMesh& mesh);

/// A tile whose vertices are in the order of its file.
struct OrderedTile {
  TileMesh mesh;
  std::vector<std::uint16_t> parent_map;
  Shading shading;  ///< as computed_shading()
};

/// Returns the tile of a node, which `mesh` is: inner vertices of a partition come into order.
OrderedTile ordered_tile(const Forest& forest, NodeId node, TileMesh mesh);

/// Returns the normals of all corners, interior triangles first, one entry a triangle: the computed
/// ones, else those of the input; 0 where neither has a direction.
std::vector<texture::CornerNormals> corner_normals(const TileMesh& mesh,
                                                   const AttributeLayout& layout,
                                                   const Shading& shading);

}  // namespace meshhier::pipeline
