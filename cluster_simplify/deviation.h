// How far a contraction moved the surface of a tile.
#pragma once

#include <vector>

namespace meshhier::cluster_simplify {

/// What a contraction did to the surface of a joined tile, its ghosts held in place.
///
/// The deviation of a triangle: none of its points is farther from the joined surface, and the
/// points of the joined surface that have come to lie on it are no farther from it.
struct Deviation {
  std::vector<float>
      around;          ///< representative -> the largest deviation of the triangles around it
  float interior = 0;  ///< the largest deviation of triangles without ghosts
  float lost = 0;      ///< of pieces that are drawn no more: the largest distance to what still is
  double squared_sum = 0;  ///< over own vertices that have triangles: weight times squared distance
                           ///< to the surface; infinite if nothing is drawn where something was
  double weight_sum = 0;   ///< over the same vertices
};

}  // namespace meshhier::cluster_simplify
