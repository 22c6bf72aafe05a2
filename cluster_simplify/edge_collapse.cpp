#include "cluster_simplify/edge_collapse.h"

#include "cluster_simplify/collapse_costs.h"
#include "cluster_simplify/collapse_driver.h"
#include "cluster_simplify/local_frame.h"
#include "cluster_simplify/representatives.h"

#include <algorithm>

namespace meshhier::cluster_simplify {
namespace {

// How strongly a point is drawn to its edge's middle, in parts of the quadric's mean curvature. On
// eight scans the mean distance falls by a twentieth from 1e-3 to 1e-5 and stays there; at 0 points
// on flat ground have nowhere to be.
constexpr float kMiddlePull = 1e-5F;

// A point further from its edge than twice the edge's length comes from planes that hardly meet: a
// spike.
constexpr float kReach = 2;

/// Vertices meet where the sum of their quadrics is least.
class OptimalPlacement {
 public:
  OptimalPlacement(const CollapseMesh& mesh, std::vector<Vec3f> positions, VertexArray& vertices)
      : mesh_(mesh),
        positions_(std::move(positions)),
        quadrics_(vertex_quadrics(mesh, positions_)),
        prices_(mesh, positions_, total_area(quadrics_)),
        vertices_(vertices) {}

  std::span<const Vec3f> positions() const { return positions_; }

  Collapse best(std::uint32_t e) const {
    const auto [a, b, count] = mesh_.edge(e);
    const Vec3f half = (positions_[b] - positions_[a]) * 0.5F;
    VertexQuadric sum = quadrics_[a].about(half);
    sum += quadrics_[b].about(half * -1.0F);
    Vec3f x = sum.minimum(kMiddlePull);
    const float squared_edge = 4 * dot(half, half);
    if (!(dot(x, x) <= kReach * kReach * squared_edge))
      x = {};
    return {b, a, quadric_cost(sum, x, squared_edge), positions_[a] + half + x};
  }

  float price(std::uint32_t e, TopologyChange change) const {
    const auto [a, b, count] = mesh_.edge(e);
    return prices_.of(change, a, positions_[b] - positions_[a],
                      quadrics_[a].area + quadrics_[b].area);
  }

  bool keeps_shape(const Collapse& c, Fans around_from, Fans around_to) const {
    return keeps_sides(positions_, c.from, c.to, c.place, around_from) &&
           keeps_sides(positions_, c.to, c.from, c.place, around_to);
  }

  void collapsed(const Collapse& c) {
    interpolate_attributes(c);
    VertexQuadric sum = quadrics_[c.to].about(c.place - positions_[c.to]);
    sum += quadrics_[c.from].about(c.place - positions_[c.from]);
    quadrics_[c.to] = sum;
    positions_[c.to] = c.place;
  }

 private:
  /// Attributes at the point of the edge that is nearest to the new place.
  void interpolate_attributes(const Collapse& c) {
    if (vertices_.channels == 0)
      return;
    const Vec3f along = positions_[c.from] - positions_[c.to];
    const float squared = dot(along, along);
    const float part =
        squared > 0 ? std::clamp(dot(c.place - positions_[c.to], along) / squared, 0.0F, 1.0F)
                    : 0.5F;
    const auto channels = static_cast<std::size_t>(vertices_.channels);
    float* to = vertices_.attributes.data() + c.to * channels;
    const float* from = vertices_.attributes.data() + c.from * channels;
    for (std::size_t k = 0; k < channels; ++k)
      to[k] = to[k] * (1 - part) + from[k] * part;
  }

  const CollapseMesh& mesh_;
  std::vector<Vec3f> positions_;
  std::vector<VertexQuadric> quadrics_;
  TopologyPrices prices_;
  VertexArray& vertices_;
};

}  // namespace

Contraction edge_collapse(const BuildTile& joined, std::uint32_t target,
                          const AttributeLayout& layout) {
  CollapseMesh mesh(joined.mesh);
  VertexArray vertices = joined.mesh.vertices;
  const LocalFrame frame(vertices.positions);
  OptimalPlacement costs(mesh, frame.to_local(vertices.positions), vertices);
  const FallbackCounts fallbacks = collapse_edges(mesh, costs, target);
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    const std::uint32_t root = mesh.representative(v);
    if (root != v)  // one that never moved keeps its place bit for bit
      vertices.positions[root] = frame.to_global(costs.positions()[root]);
  }
  Contraction result = choose_representatives(mesh, vertices, target);
  result.fallbacks += fallbacks;
  const auto channels = static_cast<std::size_t>(vertices.channels);
  for (std::size_t i = 0; i < result.representatives.size(); ++i) {
    normalize_average(layout,
                      std::span(result.representatives.attributes).subspan(i * channels, channels));
  }
  return result;
}

}  // namespace meshhier::cluster_simplify
