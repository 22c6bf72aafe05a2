#include "cluster_simplify/edge_collapse.h"

#include "cluster_simplify/collapse_costs.h"
#include "cluster_simplify/collapse_driver.h"
#include "cluster_simplify/local_frame.h"
#include "cluster_simplify/meeting_point.h"
#include "cluster_simplify/representatives.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace meshhier::cluster_simplify {
namespace {

Planes<float> planes_of(const VertexQuadric& q) {
  return {q.xx, q.xy, q.xz, q.yy, q.yz, q.zz, q.b.x, q.b.y, q.b.z, q.c, q.area};
}

/// Rows of a 4 x 4 matrix become its columns.
void transpose(FourFloats& a, FourFloats& b, FourFloats& c, FourFloats& d) {
  using Places = int __attribute__((vector_size(16)));
  const FourFloats ab_low = __builtin_shuffle(a, b, Places{0, 4, 1, 5});
  const FourFloats ab_high = __builtin_shuffle(a, b, Places{2, 6, 3, 7});
  const FourFloats cd_low = __builtin_shuffle(c, d, Places{0, 4, 1, 5});
  const FourFloats cd_high = __builtin_shuffle(c, d, Places{2, 6, 3, 7});
  a = __builtin_shuffle(ab_low, cd_low, Places{0, 1, 4, 5});
  b = __builtin_shuffle(ab_low, cd_low, Places{2, 3, 6, 7});
  c = __builtin_shuffle(ab_high, cd_high, Places{0, 1, 4, 5});
  d = __builtin_shuffle(ab_high, cd_high, Places{2, 3, 6, 7});
}

static_assert(sizeof(VertexQuadric) == 3 * sizeof(FourFloats));

Planes<FourFloats> four_planes(const std::array<const VertexQuadric*, 4>& quadrics) {
  std::array<std::array<FourFloats, 4>, 3> groups;
  for (std::size_t group = 0; group < 3; ++group) {
    auto& [a, b, c, d] = groups[group];
    const auto load = [&](std::size_t lane) {
      FourFloats values;
      std::memcpy(&values,
                  reinterpret_cast<const std::byte*>(quadrics[lane]) + group * sizeof values,
                  sizeof values);
      return values;
    };
    a = load(0);
    b = load(1);
    c = load(2);
    d = load(3);
    transpose(a, b, c, d);
  }
  return {groups[0][0], groups[0][1], groups[0][2], groups[0][3], groups[1][0], groups[1][1],
          groups[1][2], groups[1][3], groups[2][0], groups[2][1], groups[2][2]};
}

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
    const auto [x, y, z, cost] =
        meeting_point(planes_of(quadrics_[a]), planes_of(quadrics_[b]), half.x, half.y, half.z);
    return {b, a, cost, positions_[a] + half + Vec3f{x, y, z}};
  }

  /// What best() says of edges [first, first + costs.size()), four at a time.
  void costs(std::uint32_t first, std::span<float> costs) const {
    std::size_t i = 0;
    for (; i + 4 <= costs.size(); i += 4) {
      std::array<const VertexQuadric*, 4> p, q;
      FourFloats hx, hy, hz;
      for (std::size_t lane = 0; lane < 4; ++lane) {
        const auto [a, b, count] = mesh_.edge(first + static_cast<std::uint32_t>(i + lane));
        p[lane] = &quadrics_[a];
        q[lane] = &quadrics_[b];
        const Vec3f half = (positions_[b] - positions_[a]) * 0.5F;
        hx[lane] = half.x;
        hy[lane] = half.y;
        hz[lane] = half.z;
      }
      const FourFloats cost = meeting_point(four_planes(p), four_planes(q), hx, hy, hz).cost;
      std::memcpy(&costs[i], &cost, sizeof cost);
    }
    for (; i < costs.size(); ++i)
      costs[i] = best(first + static_cast<std::uint32_t>(i)).cost;
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
  DriftMeter drift(mesh, joined.history.weights);
  const FallbackCounts fallbacks = collapse_edges(mesh, costs, drift, target);
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    const std::uint32_t root = mesh.representative(v);
    if (root != v)  // one that never moved keeps its place bit for bit
      vertices.positions[root] = frame.to_global(costs.positions()[root]);
  }
  Contraction result =
      choose_representatives({mesh, vertices, costs.positions(), frame, drift}, target);
  result.fallbacks += fallbacks;
  const auto channels = static_cast<std::size_t>(vertices.channels);
  for (std::size_t i = 0; i < result.representatives.size(); ++i) {
    normalize_average(layout,
                      std::span(result.representatives.attributes).subspan(i * channels, channels));
  }
  return result;
}

}  // namespace meshhier::cluster_simplify
