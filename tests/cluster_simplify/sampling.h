// Distances of surfaces by dense sampling: what certain bounds are held against. Knows nothing of
// the library's own distances.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "tests/support/meshes.h"

#include <array>
#include <span>
#include <vector>

namespace meshhier::tests {

using Corners = std::array<Vec3d, 3>;

/// To the nearest point of the triangle; without area, of its edges.
double distance_to_triangle(Vec3d p, const Corners& t);

/// To the nearest of them; infinite if there are none.
double distance_to_surface(Vec3d p, std::span<const Corners> surface);

/// The points (i a + j b + k c) / steps, i + j + k = steps: the corners and edges are among them.
std::vector<Vec3d> samples_of(const Corners& t, int steps);

/// The largest distance of a sample of `from` to `onto`.
double farthest_sample(std::span<const Corners> from, std::span<const Corners> onto, int steps);

std::vector<Corners> surface_of(const TestMesh& mesh);
/// Interior and border triangles.
std::vector<Corners> surface_of(const TileMesh& mesh);

}  // namespace meshhier::tests
