// Judges a collapse, as all collapse methods do.
#pragma once

#include "cluster_simplify/edge_star.h"
#include "cluster_simplify/link_condition.h"
#include "cluster_simplify/local_frame.h"
#include "cluster_simplify/meeting_point.h"
#include "cluster_simplify/vertex_quadric.h"
#include "hierarchy/tile_mesh.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// The summed squared distance, weighted with twice the area, of a point to the planes of both
/// vertices, and a little for the edge's length: on flat ground, where planes cost nothing, short
/// edges go first.
inline float quadric_cost(const VertexQuadric& sum, Vec3f x, float squared_edge) {
  return std::max(0.0F, sum.at(x)) + kLengthCost * sum.area * squared_edge;
}

/// Whether no triangle around an edge, those at the edge itself aside, turns by more than about 78
/// degrees when its ends move to `place`. `star`: as seen from there if it is a disc. O(triangles).
bool keeps_sides(std::span<const Vec3f> positions, const EdgeStar& star, Vec3f place);

/// Prices of collapses that change topology, which quadrics do not see. Noise closes its holes and
/// handles, and specks of it vanish, when that harms less than any other collapse.
class TopologyPrices {
 public:
  /// `tile` and `frame`: as they were before the first collapse, and stay. `area`: twice that of
  /// the whole tile.
  TopologyPrices(const TileMesh& tile, const LocalFrame& frame, float area);

  /// In the units of quadric_cost. `vertex`: an end of the edge; `along`: the edge; `area`: twice
  /// that of the surface its ends stand for.
  float of(TopologyChange change, std::uint32_t vertex, Vec3f along, float area) const;

 private:
  const std::vector<float>& vanishing() const;

  const TileMesh& tile_;
  const LocalFrame& frame_;
  float least_area_;  ///< twice what a piece counts for at least
  /// Squared distance from a piece to the next larger one; most tiles have no small piece, and
  /// never ask for it.
  mutable std::optional<std::vector<float>> vanishing_;
};

}  // namespace meshhier::cluster_simplify
