// Measures how far the surface is off if it loses a small piece of itself.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"

#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// For each vertex of a connected piece of at most 32 vertices, all of them own: the mean squared
/// distance from the piece's vertices to the nearest vertex of a larger piece. That is how far the
/// surface is off where the piece was, once it has collapsed to nothing. Where all pieces are
/// small, as the houses of a city, it is that to the piece's own middle: the smallest go first,
/// wherever they stand. Infinite for the vertices of larger pieces: they do not vanish before they
/// have become small. `positions`: one per vertex. O(n), and O(n log n) if there are small pieces.
std::vector<float> vanishing_distances(const TileMesh& tile, std::span<const Vec3f> positions);

}  // namespace meshhier::cluster_simplify
