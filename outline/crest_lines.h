// Ridges and valleys of a surface: what a draughtsman would draw of a face.
//
// A crest is where the surface bends most across its line: the larger principal curvature has a
// maximum along its own direction (Yoshizawa, Belyaev & Seidel, Fast and Robust Detection of Crest
// Lines on Meshes, 2005). Curvature is what fits the differences of smoothed normals best, vertex
// by vertex.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"

#include <vector>

namespace meshhier::outline {

struct CrestLine {
  std::vector<Vec3f> points;  ///< two or more; a closed one repeats its first as its last
  /// How much more the surface bends across it than along it: the difference of curvatures times
  /// length, summed up.
  double strength = 0;
};

/// Convex ones (ridges), then concave ones (valleys), of what lies between own vertices. What
/// hardly bends has none. The result does not depend on the unit of length. Deterministic, O(t log
/// t) for t triangles.
std::vector<CrestLine> crest_lines(const TileMesh& tile);

}  // namespace meshhier::outline
