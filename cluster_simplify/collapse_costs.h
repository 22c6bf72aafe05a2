// What the collapse methods have in common in judging a collapse.
#pragma once

#include "cluster_simplify/collapse_driver.h"
#include "cluster_simplify/meeting_point.h"
#include "cluster_simplify/vertex_quadric.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// The summed squared distance, weighted with twice the area, of a point to the planes of both
/// vertices, and a little for the edge's length: on flat ground, where planes cost nothing, short
/// edges go first.
inline float quadric_cost(const VertexQuadric& sum, Vec3f x, float squared_edge) {
  return std::max(0.0F, sum.at(x)) + kLengthCost * sum.area * squared_edge;
}

/// Whether no triangle around `vertex`, those at the edge to `other` aside, turns by more than
/// about 78 degrees when the vertex moves to `place`. O(fans).
bool keeps_sides(std::span<const Vec3f> positions, std::uint32_t vertex, std::uint32_t other,
                 Vec3f place, Fans fans);

/// What a collapse costs that changes topology: quadrics do not see it. Noise closes its holes and
/// handles, and specks of it vanish, when that harms less than any other collapse.
class TopologyPrices {
 public:
  /// `area`: twice that of the whole tile.
  TopologyPrices(const CollapseMesh& mesh, std::span<const Vec3f> positions, float area);

  /// In the units of quadric_cost. `vertex`: an end of the edge; `along`: the edge; `area`: twice
  /// that of the surface its ends stand for.
  float of(TopologyChange change, std::uint32_t vertex, Vec3f along, float area) const;

 private:
  float least_area_;              ///< twice what a piece counts for at least
  std::vector<float> vanishing_;  ///< squared distance from a piece to the next larger one
};

}  // namespace meshhier::cluster_simplify
