#include "cluster_simplify/edge_collapse.h"

#include "base/four_floats.h"
#include "cluster_simplify/collapse_costs.h"
#include "cluster_simplify/collapse_driver.h"
#include "cluster_simplify/local_frame.h"
#include "cluster_simplify/meeting_point.h"
#include "cluster_simplify/representatives.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

/// Rows of a 4 x 4 matrix become its columns.
void transpose(FourFloats& a, FourFloats& b, FourFloats& c, FourFloats& d) {
  const FourFloats ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
  const FourFloats ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const FourFloats cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const FourFloats cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

static_assert(sizeof(VertexQuadric) == 3 * sizeof(FourFloats));

struct FourColumns {
  FourFloats a, b, c, d;
};

Planes<FourFloats> four_planes(const std::array<const VertexQuadric*, 4>& quadrics) {
  const auto columns = [&](std::size_t group) {
    const auto load = [&](std::size_t lane) {
      return load_four(reinterpret_cast<const std::byte*>(quadrics[lane]) +
                       group * sizeof(FourFloats));
    };
    FourColumns rows{load(0), load(1), load(2), load(3)};
    transpose(rows.a, rows.b, rows.c, rows.d);
    return rows;
  };
  const FourColumns first = columns(0);
  const FourColumns second = columns(1);
  const FourColumns third = columns(2);
  return {first.a,  first.b,  first.c, first.d, second.a, second.b,
          second.c, second.d, third.a, third.b, third.c};
}

/// All that an edge's cost needs of one of its ends, in a cache line.
struct alignas(64) PlacedQuadric {
  VertexQuadric quadric;
  Vec3f position;
  float unused = 0;  ///< the position's fourth lane

  FourFloats place() const { return load_four(&position); }
};

std::vector<PlacedQuadric> placed(std::span<const VertexQuadric> quadrics,
                                  std::span<const Vec3f> positions) {
  std::vector<PlacedQuadric> result;
  result.reserve(quadrics.size());
  for (std::size_t v = 0; v < quadrics.size(); ++v)
    result.push_back({quadrics[v], positions[v]});
  return result;
}

/// Vertices meet where the sum of their quadrics is least.
class OptimalPlacement {
 public:
  OptimalPlacement(const CollapseMesh& mesh, const TileMesh& tile, const LocalFrame& frame,
                   std::span<const PlaceEdge> seams, const AttributeRules& rules,
                   VertexArray& vertices)
      : mesh_(mesh),
        positions_(frame.to_local(tile.vertices.positions)),
        rules_(rules),
        vertices_(vertices) {
    const std::vector<VertexQuadric> quadrics = vertex_quadrics(mesh, positions_, seams);
    prices_.emplace(tile, frame, total_area(quadrics));
    placed_ = placed(quadrics, positions_);
  }

  std::span<const Vec3f> positions() const { return positions_; }

  void best(std::span<const std::uint32_t> edges, std::span<Collapse> collapses) const {
    for (const std::uint32_t e : edges) {
      __builtin_prefetch(&placed_[mesh_.edge(e).a]);
      __builtin_prefetch(&placed_[mesh_.edge(e).b]);
    }
    for (std::size_t i = 0; i < edges.size(); i += 4) {
      const auto some = edges.subspan(i, std::min<std::size_t>(4, edges.size() - i));
      const FourEdges four =
          look_up([&](std::size_t lane) { return some[std::min(lane, some.size() - 1)]; });
      const MeetingPoint<FourFloats> meeting = meet(four);
      for (std::size_t lane = 0; lane < some.size(); ++lane) {
        const Vec3f half{four.hx[lane], four.hy[lane], four.hz[lane]};
        const Vec3f offset{meeting.x[lane], meeting.y[lane], meeting.z[lane]};
        const CollapseMesh::Edge& edge = mesh_.edge(some[lane]);
        collapses[i + lane] = {edge.b, edge.a, meeting.cost[lane],
                               placed_[edge.a].position + half + offset};
      }
    }
  }

  void costs(std::uint32_t first, std::span<float> costs) const {
    for (std::size_t i = 0; i < costs.size(); i += 4) {
      const std::size_t count = std::min<std::size_t>(4, costs.size() - i);
      const auto begin = first + static_cast<std::uint32_t>(i);
      const auto last = static_cast<std::uint32_t>(count - 1);
      const FourFloats cost =
          meet(look_up([&](std::uint32_t lane) { return begin + std::min(lane, last); })).cost;
      std::memcpy(&costs[i], &cost, count * sizeof(float));
    }
  }

  float price(std::uint32_t e, TopologyChange change) const {
    const auto [a, b, count] = mesh_.edge(e);
    return prices_->of(change, a, positions_[b] - positions_[a],
                       placed_[a].quadric.area + placed_[b].quadric.area);
  }

  void collapsed(const Collapse& c) {
    interpolate_attributes(c);
    VertexQuadric sum = placed_[c.to].quadric.about(c.place - positions_[c.to]);
    sum += placed_[c.from].quadric.about(c.place - positions_[c.from]);
    placed_[c.to] = {sum, c.place};
    positions_[c.to] = c.place;
  }

 private:
  struct FourEdges {
    std::array<const VertexQuadric*, 4> a, b;
    FourFloats hx, hy, hz;  ///< from a half the way to b
  };

  template <class EdgeOf>
  FourEdges look_up(const EdgeOf& edge_of) const {
    FourEdges four;
    const auto half_way = [&](std::uint32_t lane) {
      const CollapseMesh::Edge& edge = mesh_.edge(edge_of(lane));
      const PlacedQuadric& a = placed_[edge.a];
      const PlacedQuadric& b = placed_[edge.b];
      four.a[lane] = &a.quadric;
      four.b[lane] = &b.quadric;
      return (b.place() - a.place()) * 0.5F;
    };
    four.hx = half_way(0);
    four.hy = half_way(1);
    four.hz = half_way(2);
    FourFloats rest = half_way(3);
    transpose(four.hx, four.hy, four.hz, rest);
    return four;
  }

  static MeetingPoint<FourFloats> meet(const FourEdges& four) {
    return meeting_point(four_planes(four.a), four_planes(four.b), four.hx, four.hy, four.hz);
  }

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
    rules_.move(vertices_.attributes.data() + c.to * channels,
                vertices_.attributes.data() + c.from * channels, part);
  }

  const CollapseMesh& mesh_;
  std::vector<Vec3f> positions_;
  std::vector<PlacedQuadric> placed_;
  std::optional<TopologyPrices> prices_;
  const AttributeRules& rules_;
  VertexArray& vertices_;
};

}  // namespace

Contraction edge_collapse(const BuildTile& joined, std::uint32_t target,
                          const AttributeRules& rules, std::span<const PlaceEdge> seams) {
  CollapseMesh mesh(joined.mesh);
  VertexArray vertices = joined.mesh.vertices;
  const LocalFrame frame(surface_bounds(mesh, vertices.positions));
  OptimalPlacement costs(mesh, joined.mesh, frame, seams, rules, vertices);
  DeviationMeter deviation(mesh, joined.history.weights);
  const FallbackCounts fallbacks = collapse_edges(mesh, costs, deviation, target);
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    const std::uint32_t root = mesh.representative(v);
    if (root != v)  // one that never moved keeps its place bit for bit
      vertices.positions[root] = frame.to_global(costs.positions()[root]);
  }
  Contraction result = choose_representatives(
      {joined.mesh, mesh, vertices, costs.positions(), frame, deviation, fallbacks}, target);
  result.fallbacks += fallbacks;
  const auto channels = static_cast<std::size_t>(vertices.channels);
  for (std::size_t i = 0; i < result.representatives.size(); ++i) {
    rules.normalize(std::span(result.representatives.attributes).subspan(i * channels, channels));
  }
  return result;
}

}  // namespace meshhier::cluster_simplify
