#include "cluster_simplify/half_edge.h"

#include "cluster_simplify/collapse_costs.h"
#include "cluster_simplify/collapse_driver.h"
#include "cluster_simplify/local_frame.h"
#include "cluster_simplify/representatives.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::cluster_simplify {
namespace {

/// Returns the collapse that costs less; the first of equal ones.
Collapse cheaper(Collapse first, Collapse second) {
  return second.cost < first.cost ? second : first;
}

/// One vertex takes over the other's quadric.
class QuadricCosts {
 public:
  QuadricCosts(CollapseMesh& mesh, const TileMesh& tile, const LocalFrame& frame,
               std::span<const PlaceEdge> seams)
      : mesh_(mesh),
        positions_(frame.to_local(tile.vertices.positions)),
        quadrics_(vertex_quadrics(mesh, positions_, seams)),
        prices_(tile, frame, total_area(quadrics_)) {}

  std::span<const Vec3f> positions() const { return positions_; }

  void best(std::span<const std::uint32_t> edges, std::span<Collapse> collapses) const {
    std::transform(edges.begin(), edges.end(), collapses.begin(),
                   [this](std::uint32_t e) { return best(e); });
  }

  void costs(std::uint32_t first, std::span<float> costs) const {
    for (std::size_t i = 0; i < costs.size(); ++i)
      costs[i] = best(first + static_cast<std::uint32_t>(i)).cost;
  }

  float price(std::uint32_t e, TopologyChange change) const {
    const auto [a, b, count] = mesh_.edge(e);
    return prices_.of(change, a, positions_[b] - positions_[a],
                      quadrics_[a].area + quadrics_[b].area);
  }

  void collapsed(const Collapse& c) {
    quadrics_[c.to] += quadrics_[c.from].about(c.place - positions_[c.from]);
  }

 private:
  Collapse best(std::uint32_t e) const {
    const auto [a, b, count] = mesh_.edge(e);
    return cheaper(onto(b, a), onto(a, b));
  }

  Collapse onto(std::uint32_t from, std::uint32_t to) const {
    const Vec3f along = positions_[to] - positions_[from];
    VertexQuadric sum = quadrics_[from].about(along);
    sum += quadrics_[to];
    return {from, to, quadric_cost(sum, {}, dot(along, along)), positions_[to]};
  }

  const CollapseMesh& mesh_;
  std::vector<Vec3f> positions_;
  std::vector<VertexQuadric> quadrics_;
  TopologyPrices prices_;
};

/// Melax, A Simple, Fast, and Effective Polygon Reduction Algorithm, 1998: an edge costs its length
/// times how far the surface bends across it. Extended to open borders, which bend where their two
/// edges do, and are not left.
class MelaxCosts {
 public:
  MelaxCosts(CollapseMesh& mesh, const TileMesh& tile, const LocalFrame& frame,
             std::span<const PlaceEdge>)
      : mesh_(mesh), positions_(frame.to_local(tile.vertices.positions)), prices_(tile, frame, 0) {}

  std::span<const Vec3f> positions() const { return positions_; }

  void best(std::span<const std::uint32_t> edges, std::span<Collapse> collapses) {
    std::transform(edges.begin(), edges.end(), collapses.begin(),
                   [this](std::uint32_t e) { return best(e); });
  }

  void costs(std::uint32_t first, std::span<float> costs) {
    for (std::size_t i = 0; i < costs.size(); ++i)
      costs[i] = best(first + static_cast<std::uint32_t>(i)).cost;
  }

  /// In Melax's unit, a length: the square root of what squared distances cost.
  float price(std::uint32_t e, TopologyChange change) const {
    const auto [a, b, count] = mesh_.edge(e);
    return std::sqrt(prices_.of(change, a, positions_[b] - positions_[a], 1));
  }

  void collapsed(const Collapse&) {}

 private:
  Collapse best(std::uint32_t e) {
    const auto [a, b, count] = mesh_.edge(e);
    return cheaper(onto(b, a), onto(a, b));
  }

  Collapse onto(std::uint32_t from, std::uint32_t to) {
    // On flat ground, where nothing bends, short edges go first.
    constexpr float kFlat = 1e-3F;
    const float size = length(positions_[to] - positions_[from]);
    if (mesh_.has_high_valence(
            from))  // it will not go; its triangles would be gone through for each
      return {from, to, std::numeric_limits<float>::infinity(), positions_[to]};
    around_ = mesh_.star_of(from, room_);
    const float bend = std::max(surface_bend(to), border_bend(from, to));
    return {from, to, size * (bend + kFlat), positions_[to]};
  }

  /// Compares each triangle around the vertex that goes with those at the edge, which stand for it
  /// afterwards: returns the largest (1 - cosine) / 2 to the more alike of these.
  float surface_bend(std::uint32_t to) {
    normals_.clear();
    at_edge_.clear();
    for (const CollapseMesh::Fan& fan : around_) {
      const auto& t = mesh_.faces()[fan.triangle].corners;
      const Vec3f n =
          cross(positions_[t[1]] - positions_[t[0]], positions_[t[2]] - positions_[t[0]]);
      const float size = length(n);
      if (!(size > 0))
        continue;
      normals_.push_back(n * (1 / size));
      if (fan.is_at(to))
        at_edge_.push_back(normals_.back());
    }
    float bend = 0;
    for (const Vec3f& n : normals_) {
      float least = 1;
      for (const Vec3f& side : at_edge_)
        least = std::min(least, (1 - dot(n, side)) / 2);
      bend = std::max(bend, least);
    }
    return std::clamp(bend, 0.0F, 1.0F);
  }

  /// 0 away from borders; 1 for leaving one; else how far the border turns at the vertex.
  float border_bend(std::uint32_t from, std::uint32_t to) const {
    bool on_border = false;
    bool along_border = false;
    float bend = 0;
    const Vec3f ahead = positions_[to] - positions_[from];
    const auto look = [&](std::uint32_t e, std::uint32_t other) {
      if (mesh_.edge(e).triangle_count != 1)
        return;
      on_border = true;
      along_border = along_border || other == to;
      const Vec3f side = positions_[other] - positions_[from];
      const float sizes = length(ahead) * length(side);
      if (other != to && sizes > 0)
        bend = std::max(bend, (1 + dot(ahead, side) / sizes) / 2);
    };
    for (const CollapseMesh::Fan& fan : around_) {
      look(fan.next_edge, fan.next);
      look(fan.previous_edge, fan.previous);
    }
    return !on_border ? 0 : along_border ? std::min(bend, 1.0F) : 1;
  }

  CollapseMesh& mesh_;
  std::vector<Vec3f> positions_;
  TopologyPrices prices_;
  std::vector<CollapseMesh::Fan> room_;
  Fans around_;
  std::vector<Vec3f> normals_, at_edge_;
};

template <class Costs>
Contraction contract_with(const BuildTile& joined, std::uint32_t target,
                          std::span<const PlaceEdge> seams) {
  CollapseMesh mesh(joined.mesh);
  const VertexArray& vertices = joined.mesh.vertices;
  const LocalFrame frame(surface_bounds(mesh, vertices.positions));
  Costs costs(mesh, joined.mesh, frame, seams);
  DeviationMeter deviation(mesh, joined.history.weights);
  const FallbackCounts fallbacks = collapse_edges(mesh, costs, deviation, target);
  Contraction result = choose_representatives(
      {joined.mesh, mesh, vertices, costs.positions(), frame, deviation, fallbacks}, target);
  result.fallbacks += fallbacks;
  return result;
}

}  // namespace

Contraction half_edge(const BuildTile& joined, std::uint32_t target, HalfEdgeCost cost,
                      std::span<const PlaceEdge> seams) {
  return cost == HalfEdgeCost::melax ? contract_with<MelaxCosts>(joined, target, seams)
                                     : contract_with<QuadricCosts>(joined, target, seams);
}

}  // namespace meshhier::cluster_simplify
