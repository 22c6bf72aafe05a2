// Computed normals for samples, with splits where a vertex has several.
#pragma once

#include "hierarchy/published.h"
#include "tests/support/sample_hierarchy.h"

namespace meshhier::tests {

/// All of it follows from hashes of what the tiles of a level know alike, so neighbours agree where
/// their copies do: each vertex has one to three normals, and each corner takes one of them by its
/// triangle. A tile has those splits that its triangles use.
Shading sample_shading(const PublishedTile& tile);

/// Gives all tiles of a sample one, and says so in its manifest. Requires a layout without normals.
/// Comes last: a tile's shading follows from its mesh.
void add_shading(Sample& sample);

}  // namespace meshhier::tests
