// How far a contraction moved the surface of a tile.
#pragma once

#include <vector>

namespace meshhier::cluster_simplify {

/// How far a contraction moved the surface of a joined tile, its ghosts held in place.
///
/// The deviation of a triangle: none of its points is farther from the joined surface, and the
/// points of the joined surface that have come to lie on it are no farther from it.
struct Deviation {
  std::vector<float>
      around;          ///< representative -> the largest deviation of the triangles around it
  float interior = 0;  ///< the largest deviation of triangles without ghosts
  float lost = 0;      ///< of pieces that are drawn no more: the largest distance to what still is
  double mean_square = 0;  ///< of distances, over own vertices that have triangles or over area,
                           ///< whichever is larger (area_mean.h); infinite if nothing is drawn
                           ///< where something was
};

}  // namespace meshhier::cluster_simplify
