#include "partition/graph.h"

#include "base/union_find.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <numeric>

namespace meshhier::partition {
namespace {

constexpr std::uint32_t kNoPlace = 0xffffffff;

// The mean length in steps: rounding is nothing beside the measure's own choice of lines ...
constexpr double kMeanSteps = 512;
// ... unless there are more than 2^20 lines: their sum stays below 2^29, and with edges that weigh
// no length, and links, far below 2^30. Then twice any weight fits an int32.
constexpr double kMostSteps = 536870912;

// Lines are summed as integers, so that any order gives the same mean: parts of a sixth of the
// diagonal, at most two whole ones a line.
constexpr double kDiagonalParts = 274877906944;  // 2^38; twice for 2^22 lines fits 2^63

/// Builds the arcs between groups of a surface's vertices.
class ArcBuilder {
 public:
  ArcBuilder(const Surface& surface, std::span<const std::uint32_t> group_of, std::uint32_t count)
      : surface_(surface), count_(count), first_(std::size_t{count} + 2) {
    find_crossings(group_of);
    // Edges within a group go to a row of their own behind the others, to spare branches.
    for (const Crossing& crossing : crossings()) {
      const auto [a, b, c] = crossing.group;
      ++first_[row_of(a, b) + 1];
      ++first_[row_of(b, c) + 1];
      ++first_[row_of(c, a) + 1];
    }
    first_.back() = 0;
    std::partial_sum(first_.begin(), first_.end() - 1, first_.begin());
    edges_ = std::make_unique_for_overwrite<Graph::Arc[]>(std::size_t{first_[count]} + 1);
    end_.assign(first_.begin(), first_.end() - 1);
    for (const Crossing& crossing : crossings())
      add_edges(crossing);
    end_.pop_back();
    crossings_.reset();
  }

  void run(Graph& graph) {
    merge_rows();
    graph.first.assign(count_ + 1, 0);
    for (std::uint32_t v = 0; v < count_; ++v) {
      for (std::uint32_t i = first_[v]; i < end_[v]; ++i)
        ++graph.first[edges_[i].to + 1];
      graph.first[v + 1] += end_[v] - first_[v];
    }
    std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
    graph.arcs.resize(graph.first.back());
    // Rows come out ascending: first all arcs to lower vertices, by vertex ...
    std::vector<std::uint32_t> next(graph.first.begin(), graph.first.end() - 1);
    for (std::uint32_t v = 0; v < count_; ++v) {
      for (std::uint32_t i = first_[v]; i < end_[v]; ++i)
        graph.arcs[next[edges_[i].to]++] = {v, edges_[i].weight};
    }
    // ... then, from these, all arcs to higher ones. What is next in a row ends its lower part.
    for (std::uint32_t v = 0; v < count_; ++v) {
      for (std::uint32_t i = graph.first[v], end = next[v]; i < end; ++i)
        graph.arcs[next[graph.arcs[i].to]++] = {v, graph.arcs[i].weight};
    }
  }

 private:
  /// A triangle with corners in several groups.
  struct Crossing {
    std::uint32_t triangle;
    std::array<std::uint32_t, 3> group;
  };

  std::span<const Crossing> crossings() const { return {crossings_.get(), crossing_count_}; }

  void find_crossings(std::span<const std::uint32_t> group_of) {
    crossings_ = std::make_unique_for_overwrite<Crossing[]>(surface_.triangles.size() + 1);
    for (std::uint32_t i = 0; i < surface_.triangles.size(); ++i) {
      const Triangle<std::uint32_t>& t = surface_.triangles[i];
      const std::uint32_t a = group_of[t[0]], b = group_of[t[1]], c = group_of[t[2]];
      crossings_[crossing_count_] = {i, {a, b, c}};
      crossing_count_ += static_cast<std::uint32_t>(a != b) | static_cast<std::uint32_t>(b != c);
    }
  }

  /// The row of an edge: the lower of its two groups; `count_` within a group.
  std::uint32_t row_of(std::uint32_t a, std::uint32_t b) const {
    return a == b ? count_ : std::min(a, b);
  }

  void add_edges(const Crossing& crossing) {
    const Triangle<std::uint32_t>& t = surface_.triangles[crossing.triangle];
    const Vec3f p = surface_.positions[t[0]], q = surface_.positions[t[1]],
                r = surface_.positions[t[2]];
    const auto [a, b, c] = crossing.group;
    add_edge(a, b, p + q - r * 2.0F);
    add_edge(b, c, q + r - p * 2.0F);
    add_edge(c, a, r + p - q * 2.0F);
  }

  /// Puts an edge into the row of its lower end, with the bits of its line's length in sixths of
  /// the diagonal for a weight. `line`: from centroid to midpoint, six times; (a + b) / 2
  /// less (a + b + c) / 3 is (a + b - 2 c) / 6.
  void add_edge(std::uint32_t a, std::uint32_t b, Vec3f line) {
    const float size = std::sqrt(dot(line, line));
    const std::uint32_t row = row_of(a, b);
    const std::uint32_t counts = row != count_ ? 1 : 0;
    sum_ += static_cast<std::int64_t>(double{size} * kDiagonalParts) & -std::int64_t{counts};
    edges_[end_[row]] = {std::max(a, b), std::bit_cast<std::uint32_t>(size)};
    end_[row] += counts;
  }

  /// Multiply a length with it to get steps.
  float steps() const {
    if (sum_ == 0)
      return 0;
    const auto count = static_cast<double>(first_[count_]);
    const double mean = static_cast<double>(sum_) / kDiagonalParts / count;
    return static_cast<float>(std::min(kMeanSteps, kMostSteps / count) / mean);
  }

  /// Leaves one edge to each neighbour, weighing its lines' steps.
  void merge_rows() {
    const float scale = steps();
    std::vector<std::uint32_t> place(end_.size());  // where a group is in the row, if it is
    for (std::uint32_t v = 0; v < end_.size(); ++v) {
      std::uint32_t end = first_[v];
      for (std::uint32_t i = first_[v]; i < end_[v]; ++i) {
        const auto [to, bits] = edges_[i];
        const std::uint32_t weight =
            std::max(1U, static_cast<std::uint32_t>(std::bit_cast<float>(bits) * scale));
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

  const Surface& surface_;
  std::uint32_t count_;
  std::unique_ptr<Crossing[]> crossings_;
  std::size_t crossing_count_ = 0;
  std::vector<std::uint32_t> first_;  ///< rows of the lower ends
  std::vector<std::uint32_t> end_;
  std::unique_ptr<Graph::Arc[]> edges_;
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

Graph surface_graph(const Surface& surface, std::span<const std::uint32_t> group_of,
                    std::uint32_t count) {
  Graph graph;
  graph.weight.assign(count, 0);
  graph.center.resize(count);
  for (std::uint32_t v = 0; v < surface.size(); ++v) {
    ++graph.weight[group_of[v]];
    graph.center[group_of[v]] = surface.positions[v];
  }
  ArcBuilder(surface, group_of, count).run(graph);
  return graph;
}

Graph surface_graph(const Surface& surface) {
  std::vector<std::uint32_t> alone(surface.size());
  std::iota(alone.begin(), alone.end(), 0U);
  return surface_graph(surface, alone, surface.size());
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
  std::vector<std::uint32_t> place(count, kNoPlace);  // of the arc to a cluster, if in this row
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
        if (place[to] != kNoPlace && place[to] >= row) {
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
