#include "outline/outline_builder.h"

#include "outline/polyline.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::outline {
namespace {

/// A vertex over all sectors: sector << 32 | index in it.
using VertexKey = std::uint64_t;

std::uint32_t sector_of(VertexKey vertex) {
  return static_cast<std::uint32_t>(vertex >> 32);
}

struct Corner {
  VertexKey key;
  Vec3f position;
};

/// Corners by ascending key: both sides of a line compute its points from the same order.
using CornerTriangle = std::array<Corner, 3>;
using CornerEdge = std::array<Corner, 2>;

/// A point of a line: a vertex (v, v, v), an edge's midpoint (a, b, b) or a triangle's centroid
/// (a, b, c), corners ascending.
struct Point {
  std::array<VertexKey, 3> key;
  Vec3f position;
};

struct Segment {
  Point a, b;
};

Point vertex_point(const Corner& v) {
  return {{v.key, v.key, v.key}, v.position};
}

Point midpoint(const CornerEdge& e) {
  const Vec3d sum = to_double(e[0].position) + to_double(e[1].position);
  return {{e[0].key, e[1].key, e[1].key}, to_float(sum * 0.5)};
}

Point centroid(const CornerTriangle& t) {
  const Vec3d sum = to_double(t[0].position) + to_double(t[1].position) + to_double(t[2].position);
  return {{t[0].key, t[1].key, t[2].key}, to_float(sum * (1.0 / 3))};
}

std::array<CornerEdge, 3> edges_of(const CornerTriangle& t) {
  return {CornerEdge{t[0], t[1]}, CornerEdge{t[0], t[2]}, CornerEdge{t[1], t[2]}};
}

bool is_crossing(const CornerEdge& e) {
  return sector_of(e[0].key) != sector_of(e[1].key);
}

template <std::size_t n>
bool before(const std::array<Corner, n>& a, const std::array<Corner, n>& b) {
  return std::lexicographical_compare(
      a.begin(), a.end(), b.begin(), b.end(),
      [](const Corner& x, const Corner& y) { return x.key < y.key; });
}

template <std::size_t n>
bool same(const std::array<Corner, n>& a, const std::array<Corner, n>& b) {
  return !before(a, b) && !before(b, a);
}

/// Calls visit(first, last) for every run of equal elements of a sorted range.
template <class Element, class Visit>
void for_each_run(std::span<const Element> sorted, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first < sorted.size(); first = last) {
    while (last < sorted.size() && same(sorted[first], sorted[last]))
      ++last;
    visit(first, last);
  }
}

/// Edges (lower, higher) of two own vertices that exactly one triangle of the tile has. All their
/// triangles are in the tile, as interior or border triangles. By counting sort: O(triangles) where
/// vertices have bounded degree.
std::vector<std::array<std::uint32_t, 2>> own_border_edges(const TileMesh& tile) {
  std::vector<std::uint32_t> first(tile.own_count + 1, 0);
  const auto visit_edges = [&tile](auto&& visit) {
    for (const std::vector<Triangle>* triangles : {&tile.interior, &tile.border}) {
      for (const Triangle& t : *triangles) {
        if (is_degenerate(t))
          continue;
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t a = raw(t[i]), b = raw(t[(i + 1) % 3]);
          const std::uint32_t low = std::min(a, b), high = std::max(a, b);
          if (high < tile.own_count)
            visit(low, high);
        }
      }
    }
  };
  visit_edges([&](std::uint32_t low, std::uint32_t) { ++first[low + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> ends(first.back()), next(first.begin(), first.end() - 1);
  visit_edges([&](std::uint32_t low, std::uint32_t high) { ends[next[low]++] = high; });

  std::vector<std::array<std::uint32_t, 2>> result;
  for (std::uint32_t low = 0; low < tile.own_count; ++low) {
    const auto begin = ends.begin() + first[low], end = ends.begin() + first[low + 1];
    std::sort(begin, end);
    for (auto run = begin; run != end;) {
      const auto run_end = std::upper_bound(run, end, *run);
      if (run_end - run == 1)
        result.push_back({low, *run});
      run = run_end;
    }
  }
  return result;
}

/// The line through one border triangle, which has two or three crossing edges.
void add_sector_line(const CornerTriangle& triangle, std::vector<Segment>& segments) {
  std::vector<Point> crossings;
  for (const CornerEdge& edge : edges_of(triangle)) {
    if (is_crossing(edge))
      crossings.push_back(midpoint(edge));
  }
  if (crossings.size() == 2)
    return segments.push_back({crossings[0], crossings[1]});
  for (const Point& crossing : crossings)
    segments.push_back({crossing, centroid(triangle)});
}

/// A triangle and its duplicates or mirror images make one line.
void add_sector_lines(std::span<const CornerTriangle> sorted, std::vector<Segment>& segments) {
  for_each_run(sorted,
               [&](std::size_t first, std::size_t) { add_sector_line(sorted[first], segments); });
}

/// Crossing edges that exactly one triangle has.
void add_crossing_borders(std::span<const CornerTriangle> triangles,
                          std::vector<Segment>& segments) {
  std::vector<CornerEdge> edges;
  for (const CornerTriangle& t : triangles) {
    for (const CornerEdge& edge : edges_of(t)) {
      if (is_crossing(edge))
        edges.push_back(edge);
    }
  }
  std::sort(edges.begin(), edges.end(), before<2>);
  for_each_run(std::span<const CornerEdge>(edges), [&](std::size_t first, std::size_t last) {
    if (last - first > 1)
      return;
    segments.push_back({vertex_point(edges[first][0]), midpoint(edges[first])});
    segments.push_back({midpoint(edges[first]), vertex_point(edges[first][1])});
  });
}

/// Segments of numbered points; numbers ascend with the points' keys.
struct Network {
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 2>> segments;

  explicit Network(const std::vector<Segment>& loose) : segments(loose.size()) {
    /// An end of a segment, to be numbered.
    struct End {
      const Point* point;
      std::uint32_t* number;
    };
    std::vector<End> ends;
    ends.reserve(2 * loose.size());
    for (std::size_t s = 0; s < loose.size(); ++s) {
      ends.push_back({&loose[s].a, &segments[s][0]});
      ends.push_back({&loose[s].b, &segments[s][1]});
    }
    std::sort(ends.begin(), ends.end(),
              [](const End& x, const End& y) { return x.point->key < y.point->key; });
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (i == 0 || ends[i].point->key != ends[i - 1].point->key) {
        positions.push_back(ends[i].point->position);
      }
      *ends[i].number = static_cast<std::uint32_t>(positions.size() - 1);
    }
  }
};

/// All chains with the significance of their points, to be cut to any tolerance.
class Lines {
 public:
  /// `least`: the smallest tolerance that will be asked for, input units.
  Lines(const Network& network, double least)
      : chains_(
            trace_chains(static_cast<std::uint32_t>(network.positions.size()), network.segments)) {
    points_.reserve(chains_.nodes.size());
    significance_.reserve(chains_.nodes.size());
    for (std::uint32_t node : chains_.nodes)
      points_.push_back(network.positions[node]);
    for (std::size_t chain = 0; chain < chains_.size(); ++chain) {
      const std::span<const std::uint32_t> nodes = chains_[chain];
      const std::vector<double> values =
          significance(points_of(chain), nodes.front() == nodes.back(), least);
      significance_.insert(significance_.end(), values.begin(), values.end());
    }
  }

  std::size_t size() const { return chains_.size(); }

  /// Vertices of a chain that are left with a tolerance in input units.
  std::size_t vertex_count(std::size_t chain, double tolerance) const {
    const auto begin = significance_.begin() + chains_.starts[chain];
    const auto end = significance_.begin() + chains_.starts[chain + 1];
    return static_cast<std::size_t>(
        std::count_if(begin, end, [&](double value) { return value > tolerance; }));
  }

  void append_to(Outline& outline, std::size_t chain, double tolerance) const {
    for (std::uint32_t i = chains_.starts[chain]; i < chains_.starts[chain + 1]; ++i) {
      if (significance_[i] > tolerance)
        outline.vertices.push_back(points_[i]);
    }
    outline.starts.push_back(static_cast<std::uint32_t>(outline.vertices.size()));
  }

  /// Chains by length in input units, the longest first, equal ones in order.
  std::vector<std::uint32_t> by_length() const {
    std::vector<double> lengths(size());
    for (std::size_t i = 0; i < size(); ++i)
      lengths[i] = length_of(points_of(i));
    std::vector<std::uint32_t> order(size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return lengths[a] > lengths[b]; });
    return order;
  }

 private:
  std::span<const Vec3f> points_of(std::size_t chain) const {
    return std::span(points_).subspan(chains_.starts[chain],
                                      chains_.starts[chain + 1] - chains_.starts[chain]);
  }

  Chains chains_;
  std::vector<Vec3f> points_;         ///< of chains_.nodes
  std::vector<double> significance_;  ///< likewise
};

/// Which chains an outline is made of, with which tolerance.
struct Selection {
  std::vector<std::uint32_t> chains;  ///< ascending
  double tolerance = 0;               ///< part of the diagonal
};

bool fits(const OutlineOptions& options, std::size_t vertices, std::size_t polylines) {
  return !options.file_bytes ||
         options.file_bytes(vertices, vertices - polylines) <= options.max_bytes;
}

/// The longest chains of `order`, as many as fit.
std::vector<std::uint32_t> longest_that_fit(const Lines& lines, const OutlineOptions& options,
                                            double tolerance) {
  std::vector<std::uint32_t> chains = lines.by_length();
  std::size_t vertices = 0, count = 0;
  for (; count < chains.size(); ++count) {
    vertices += lines.vertex_count(chains[count], tolerance * options.diagonal);
    if (!fits(options, vertices, count + 1))
      break;
  }
  chains.resize(count);
  std::sort(chains.begin(), chains.end());
  return chains;
}

Selection select(const Lines& lines, const OutlineOptions& options) {
  Selection result{std::vector<std::uint32_t>(lines.size()), options.tolerance};
  std::iota(result.chains.begin(), result.chains.end(), 0u);
  while (true) {
    std::size_t vertices = 0;
    for (std::size_t chain = 0; chain < lines.size(); ++chain) {
      vertices += lines.vertex_count(chain, result.tolerance * options.diagonal);
    }
    if (fits(options, vertices, lines.size()))
      return result;
    if (result.tolerance >= kCoarsestTolerance)
      break;
    result.tolerance = std::min(2 * result.tolerance, kCoarsestTolerance);
  }
  result.chains = longest_that_fit(lines, options, result.tolerance);
  return result;
}

}  // namespace

struct OutlineBuilder::Parts {
  std::vector<CornerTriangle> triangles;  ///< border triangles, each once
  std::vector<CornerEdge> border_edges;   ///< the mesh's own, within one sector
};

OutlineBuilder::OutlineBuilder() : parts_(std::make_unique<Parts>()) {}
OutlineBuilder::OutlineBuilder(OutlineBuilder&&) noexcept = default;
OutlineBuilder& OutlineBuilder::operator=(OutlineBuilder&&) noexcept = default;
OutlineBuilder::~OutlineBuilder() = default;

void OutlineBuilder::add(std::uint32_t index, const TileMesh& tile) {
  const auto corner = [&](std::uint32_t vertex) -> Corner {
    const TileVertex v{vertex};
    const std::uint32_t sector = tile.is_own(v) ? index : tile.ghost(v).tile;
    const std::uint32_t own = tile.is_own(v) ? vertex : tile.ghost(v).index;
    return {VertexKey{sector} << 32 | own, tile.vertices.positions[vertex]};
  };
  for (const Triangle& t : tile.border) {
    if (is_degenerate(t))
      continue;
    CornerTriangle triangle = {corner(raw(t[0])), corner(raw(t[1])), corner(raw(t[2]))};
    std::sort(triangle.begin(), triangle.end(),
              [](const Corner& a, const Corner& b) { return a.key < b.key; });
    // Every tile it touches has it; the lowest brings it.
    if (sector_of(triangle[0].key) == index)
      parts_->triangles.push_back(triangle);
  }
  for (const auto& [low, high] : own_border_edges(tile)) {
    parts_->border_edges.push_back({corner(low), corner(high)});
  }
}

OutlineResult OutlineBuilder::finish(const OutlineOptions& options) const {
  assert(options.tolerance > 0 && options.diagonal >= 0);
  std::vector<CornerTriangle> triangles = parts_->triangles;
  std::sort(triangles.begin(), triangles.end(), before<3>);
  std::vector<Segment> segments;
  add_sector_lines(triangles, segments);
  add_crossing_borders(triangles, segments);
  for (const CornerEdge& e : parts_->border_edges) {
    segments.push_back({vertex_point(e[0]), vertex_point(e[1])});
  }

  const Lines lines(Network(segments), options.tolerance * options.diagonal);
  const Selection selection = select(lines, options);
  OutlineResult result;
  result.tolerance = selection.tolerance;
  result.polylines_found = lines.size();
  result.polylines_dropped = lines.size() - selection.chains.size();
  for (std::uint32_t chain : selection.chains) {
    lines.append_to(result.outline, chain, selection.tolerance * options.diagonal);
  }
  return result;
}

}  // namespace meshhier::outline
