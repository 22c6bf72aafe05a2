// Smooth normals of a tile of a mesh that has none.
#pragma once

#include "hierarchy/shading.h"
#include "hierarchy/tile_mesh.h"

namespace meshhier::shading {

/// Computes the normals of a tile's own vertices; its ghosts must have their positions. A vertex
/// has the normals of the smooth pieces of surface (group_fans) that its triangles belong to, each
/// the mean of their triangles' normals by area; the largest piece's first. Vertices of one place
/// with different attributes agree where the surface is smooth. A vertex without area looks along
/// z. Pure, deterministic; O(n log n), however many triangles meet at a place.
OwnShading shade(const TileMesh& mesh);

}  // namespace meshhier::shading
