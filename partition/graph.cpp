#include "partition/graph.h"

#include "hierarchy/bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace meshhier::partition {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

// The mean length in steps: rounding is nothing beside the measure's own choice of lines ...
constexpr double kMeanSteps = 512;
// ... unless there are more than 2^20 lines: their sum stays below 2^29, and with edges that weigh
// no length, and links, far below 2^30. Then twice any weight fits an int32.
constexpr double kMostSteps = 536870912;

// Lines are summed as integers, so that any order gives the same mean: parts of the diagonal.
constexpr double kDiagonalParts = 1099511627776;  // 2^40; times 2^22 lines fits 2^63

constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93ULL;
  return x ^ (x >> 32);
}

constexpr std::uint64_t hash(const LocalTriangle& t) {
  return mix(mix(mix(t[0] + 1) + t[1]) + t[2]);
}

/// The same corners from the smallest on.
LocalTriangle turned(const LocalTriangle& t) {
  if (t[1] < t[0] && t[1] < t[2])
    return {t[1], t[2], t[0]};
  return t[2] < t[0] && t[2] < t[1] ? LocalTriangle{t[2], t[0], t[1]} : t;
}

/// The triangles of a mesh whose vertices are called first, first + 1, ...
struct TriangleView {
  std::span<const LocalTriangle> triangles;
  std::uint32_t first, vertex_count;

  /// Those without other corners, numbered from 0.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const LocalTriangle& t : triangles) {
      const LocalTriangle local{t[0] - first, t[1] - first, t[2] - first};  // wraps around below it
      if (local[0] < vertex_count && local[1] < vertex_count && local[2] < vertex_count)
        visit(local);
    }
  }
};

/// No more than `most` distinct ones of the `count` there are, chosen by their corners alone.
std::vector<LocalTriangle> choice_of(const TriangleView& view, std::size_t count,
                                     std::size_t most) {
  std::vector<LocalTriangle> chosen;
  chosen.reserve(count);
  view.for_each([&](const LocalTriangle& t) { chosen.push_back(turned(t)); });
  std::sort(chosen.begin(), chosen.end(), [](const LocalTriangle& a, const LocalTriangle& b) {
    const std::uint64_t hash_a = hash(a), hash_b = hash(b);
    return hash_a != hash_b ? hash_a < hash_b : a < b;
  });
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  chosen.resize(std::min(chosen.size(), most));
  chosen.shrink_to_fit();
  return chosen;
}

/// Positions in the unit cube, so that no length overflows or vanishes as a float.
std::vector<Vec3f> in_unit_cube(std::span<const Vec3f> positions) {
  const Bounds bounds = bounds_of(positions);
  const double size = diagonal(bounds);
  const double scale = size > 0 ? 1 / size : 0;
  const Vec3d low = to_double(bounds.min);
  std::vector<Vec3f> unit(positions.size());
  std::transform(positions.begin(), positions.end(), unit.begin(),
                 [&](const Vec3f& p) { return to_float((to_double(p) - low) * scale); });
  return unit;
}

/// Builds the arcs of a surface's graph.
class ArcBuilder {
 public:
  ArcBuilder(std::span<const Vec3f> unit, const TriangleView& view) : first_(unit.size() + 1) {
    view.for_each([&](const LocalTriangle& t) {
      for (int k = 0; k < 3; ++k)
        ++first_[std::min(t[k], t[(k + 1) % 3]) + 1];
    });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    edges_.resize(first_.back());
    end_.assign(first_.begin(), first_.end() - 1);
    view.for_each([&](const LocalTriangle& t) { add_edges_of(t, unit); });
  }

  void run(Graph& graph) {
    merge_rows();
    const auto count = static_cast<std::uint32_t>(end_.size());
    graph.first.assign(count + 1, 0);
    for (std::uint32_t v = 0; v < count; ++v) {
      for (std::uint32_t i = first_[v]; i < end_[v]; ++i)
        ++graph.first[edges_[i].to + 1];
      graph.first[v + 1] += end_[v] - first_[v];
    }
    std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
    graph.arcs.resize(graph.first.back());
    // Rows come out ascending: first all arcs to lower vertices, by vertex ...
    std::vector<std::uint32_t> next(graph.first.begin(), graph.first.end() - 1);
    for (std::uint32_t v = 0; v < count; ++v) {
      for (std::uint32_t i = first_[v]; i < end_[v]; ++i)
        graph.arcs[next[edges_[i].to]++] = {v, edges_[i].weight};
    }
    // ... then, from these, all arcs to higher ones. What is next in a row ends its lower part.
    for (std::uint32_t v = 0; v < count; ++v) {
      for (std::uint32_t i = graph.first[v], end = next[v]; i < end; ++i)
        graph.arcs[next[graph.arcs[i].to]++] = {v, graph.arcs[i].weight};
    }
  }

 private:
  /// Puts each edge into the row of its lower end, with the bits of its line's length in parts of
  /// the diagonal for a weight.
  void add_edges_of(const LocalTriangle& t, std::span<const Vec3f> unit) {
    const std::array<Vec3f, 3> p{unit[t[0]], unit[t[1]], unit[t[2]]};
    for (int k = 0; k < 3; ++k) {
      const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      // Midpoint less centroid: (a + b) / 2 - (a + b + c) / 3.
      const float line = length(p[k] + p[k1] - p[k2] * 2.0F) / 6;
      sum_ += static_cast<std::int64_t>(double{line} * kDiagonalParts);
      edges_[end_[std::min(t[k], t[k1])]++] = {std::max(t[k], t[k1]),
                                               std::bit_cast<std::uint32_t>(line)};
    }
  }

  /// Multiply a length with it to get steps.
  float steps() const {
    if (sum_ == 0)
      return 0;
    const auto count = static_cast<double>(edges_.size());
    const double mean = static_cast<double>(sum_) / kDiagonalParts / count;
    return static_cast<float>(std::min(kMeanSteps, kMostSteps / count) / mean);
  }

  /// Leaves one edge to each neighbour, weighing its lines' steps.
  void merge_rows() {
    const float scale = steps();
    std::vector<std::uint32_t> place(end_.size());  // where a vertex is in the row, if it is
    for (std::uint32_t v = 0; v < end_.size(); ++v) {
      std::uint32_t end = first_[v];
      for (std::uint32_t i = first_[v]; i < end_[v]; ++i) {
        const auto [to, bits] = edges_[i];
        const std::uint32_t weight =
            std::max(1U, static_cast<std::uint32_t>(std::bit_cast<float>(bits) * scale));
        if (to == v)  // a triangle with two equal corners
          continue;
        const std::uint32_t at = place[to];
        if (at >= first_[v] && at < end && edges_[at].to == to) {
          edges_[at].weight += weight;
        } else {
          place[to] = end;
          edges_[end++] = {to, weight};
        }
      }
      end_[v] = end;
    }
  }

  std::vector<std::uint32_t> first_;  ///< rows of the lower ends
  std::vector<std::uint32_t> end_;
  std::vector<Graph::Arc> edges_;
  std::int64_t sum_ = 0;
};

/// A coordinate's ten bits, two places apart.
constexpr std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

std::uint32_t morton_code(Vec3f unit) {
  const auto bits = [](float x) {
    return spread_bits(static_cast<std::uint32_t>(std::clamp(x, 0.0F, 1.0F) * 1023));
  };
  return bits(unit.x) | bits(unit.y) << 1 | bits(unit.z) << 2;
}

class UnionFind {
 public:
  explicit UnionFind(std::uint32_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v)
      v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  /// False if they were one already.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b)
      return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

void add_edges(Graph& graph, std::span<const std::array<std::uint32_t, 2>> edges) {
  std::vector<std::uint32_t> more(graph.size() + 1);
  for (const auto& [a, b] : edges) {
    ++more[a + 1];
    ++more[b + 1];
  }
  std::partial_sum(more.begin(), more.end(), more.begin());
  std::vector<Graph::Arc> arcs(graph.arcs.size() + 2 * edges.size());
  std::vector<std::uint32_t> next(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    const auto old = graph.arcs_of(v);
    std::copy(old.begin(), old.end(), arcs.begin() + graph.first[v] + more[v]);
    next[v] = graph.first[v + 1] + more[v];
  }
  for (const auto& [a, b] : edges) {
    arcs[next[a]++] = {b, 1};
    arcs[next[b]++] = {a, 1};
  }
  graph.arcs = std::move(arcs);
  for (std::size_t v = 0; v < graph.first.size(); ++v)
    graph.first[v] += more[v];
}

}  // namespace

Graph surface_graph(std::span<const Vec3f> positions, std::span<const LocalTriangle> triangles,
                    std::uint32_t first) {
  Graph graph;
  graph.center = in_unit_cube(positions);
  graph.weight.assign(positions.size(), 1);
  TriangleView view{triangles, first, graph.size()};
  std::vector<LocalTriangle> chosen;
  if (triangles.size() > kMostTriangles * positions.size()) {
    std::size_t count = 0;
    view.for_each([&](const LocalTriangle&) { ++count; });
    if (count > kMostTriangles * positions.size()) {
      chosen = choice_of(view, count, kMostTriangles * positions.size());
      view = {chosen, 0, graph.size()};
    }
  }
  ArcBuilder(graph.center, view).run(graph);
  return graph;
}

Graph contract(const Graph& graph, std::span<const std::uint32_t> cluster_of, std::uint32_t count) {
  std::vector<std::uint32_t> begin(count + 1);
  for (const std::uint32_t cluster : cluster_of)
    ++begin[cluster + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> members(graph.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    members[next[cluster_of[v]]++] = v;

  Graph coarse;
  coarse.first.reserve(count + 1);
  coarse.first.push_back(0);
  coarse.weight.resize(count);
  coarse.center.resize(count);
  coarse.arcs.reserve(graph.arcs.size() / 2);
  std::vector<std::uint32_t> place(count, kNone);  // of the arc to a cluster, if in this row
  for (std::uint32_t c = 0; c < count; ++c) {
    const std::uint32_t row = coarse.first[c];
    std::uint32_t weight = 0;
    Vec3d sum;
    for (std::uint32_t i = begin[c]; i < begin[c + 1]; ++i) {
      const std::uint32_t v = members[i];
      weight += graph.weight[v];
      sum = sum + to_double(graph.center[v]) * graph.weight[v];
      for (const Graph::Arc& arc : graph.arcs_of(v)) {
        const std::uint32_t to = cluster_of[arc.to];
        if (to == c)
          continue;
        if (place[to] != kNone && place[to] >= row) {
          coarse.arcs[place[to]].weight += arc.weight;
        } else {
          place[to] = static_cast<std::uint32_t>(coarse.arcs.size());
          coarse.arcs.push_back({to, arc.weight});
        }
      }
    }
    coarse.weight[c] = weight;
    coarse.center[c] = to_float(sum * (1.0 / std::max(1U, weight)));
    coarse.first.push_back(static_cast<std::uint32_t>(coarse.arcs.size()));
  }
  return coarse;
}

Graph subgraph(const Graph& graph, std::span<const std::uint32_t> vertices,
               std::span<std::uint32_t> place_of) {
  Graph part;
  part.first.push_back(0);
  for (std::uint32_t i = 0; i < vertices.size(); ++i)
    place_of[vertices[i]] = i;
  for (const std::uint32_t v : vertices) {
    for (const Graph::Arc& arc : graph.arcs_of(v)) {
      const std::uint32_t place = place_of[arc.to];
      if (place < vertices.size() && vertices[place] == arc.to)
        part.arcs.push_back({place, arc.weight});
    }
    part.first.push_back(static_cast<std::uint32_t>(part.arcs.size()));
    part.weight.push_back(graph.weight[v]);
    part.center.push_back(graph.center[v]);
  }
  return part;
}

void link_components(Graph& graph) {
  UnionFind components(graph.size());
  std::uint32_t count = graph.size();
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    for (const Graph::Arc& arc : graph.arcs_of(v))
      count -= arc.to < v && components.join(v, arc.to) ? 1 : 0;
  }
  if (count <= 1)
    return;
  std::vector<std::array<std::uint32_t, 2>> order(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    order[v] = {morton_code(graph.center[v]), v};
  std::sort(order.begin(), order.end());
  std::vector<std::array<std::uint32_t, 2>> links;
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (components.join(order[i - 1][1], order[i][1]))
      links.push_back({order[i - 1][1], order[i][1]});
  }
  add_edges(graph, links);
}

}  // namespace meshhier::partition
