#include "outline/outline_builder.h"

#include "hierarchy/error.h"
#include "outline/polyline.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <span>
#include <string>
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

/// A point of a sector line: an edge's midpoint (a, b, b) or a triangle's centroid (a, b, c),
/// corners ascending.
struct Point {
  std::array<VertexKey, 3> key;
  Vec3f position;
};

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

// Up to so many numbers are compared with each other: quicker than sorting them.
constexpr std::size_t kFew = 16;

/// Appends the numbers that are there exactly once, ascending. `numbers`: may be reordered.
void append_lonely(std::span<std::uint32_t> numbers, std::vector<std::uint32_t>& lonely) {
  if (numbers.size() <= kFew) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      std::size_t same = 0;
      for (const std::uint32_t other : numbers)
        same += other == numbers[i] ? 1 : 0;
      if (same == 1)
        lonely.push_back(numbers[i]);
    }
    if (lonely.size() > 1)
      std::sort(lonely.begin(), lonely.end());
    return;
  }
  std::sort(numbers.begin(), numbers.end());
  for (auto run = numbers.begin(); run != numbers.end();) {
    const auto run_end = std::upper_bound(run, numbers.end(), *run);
    if (run_end - run == 1)
      lonely.push_back(*run);
    run = run_end;
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
  std::vector<std::uint32_t> lonely;
  for (std::uint32_t low = 0; low < tile.own_count; ++low) {
    lonely.clear();
    append_lonely(std::span(ends).subspan(first[low], first[low + 1] - first[low]), lonely);
    for (const std::uint32_t high : lonely)
      result.push_back({low, high});
  }
  return result;
}

/// A piece of a sector line.
struct LinePiece {
  Point a, b;
};

/// The line through one border triangle, which has two or three crossing edges.
void add_sector_line(const CornerTriangle& triangle, std::vector<LinePiece>& pieces) {
  std::vector<Point> crossings;
  for (const CornerEdge& edge : edges_of(triangle)) {
    if (is_crossing(edge))
      crossings.push_back(midpoint(edge));
  }
  if (crossings.size() == 2)
    return pieces.push_back({crossings[0], crossings[1]});
  for (const Point& crossing : crossings)
    pieces.push_back({crossing, centroid(triangle)});
}

/// A triangle and its duplicates or mirror images make one line.
std::vector<LinePiece> sector_lines(std::span<const CornerTriangle> sorted) {
  std::vector<LinePiece> pieces;
  for_each_run(sorted,
               [&](std::size_t first, std::size_t) { add_sector_line(sorted[first], pieces); });
  return pieces;
}

/// Crossing edges that exactly one triangle has, ascending.
std::vector<CornerEdge> crossing_borders(std::span<const CornerTriangle> triangles) {
  std::vector<CornerEdge> edges, result;
  for (const CornerTriangle& t : triangles) {
    for (const CornerEdge& edge : edges_of(t)) {
      if (is_crossing(edge))
        edges.push_back(edge);
    }
  }
  std::sort(edges.begin(), edges.end(), before<2>);
  for_each_run(std::span<const CornerEdge>(edges), [&](std::size_t first, std::size_t last) {
    if (last - first == 1)
      result.push_back(edges[first]);
  });
  return result;
}

/// A sector's part of the mesh's own borders, small for soups that are nothing but borders: the rim
/// (where crossing borders end), then the other vertices on own border edges, ascending.
struct SectorBorder {
  std::uint32_t sector = 0;
  std::uint32_t rim_count = 0;
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< of positions
};

SectorBorder border_of(std::uint32_t sector, const TileMesh& tile) {
  SectorBorder border{sector, tile.rim_count, {}, own_border_edges(tile)};
  std::vector<std::uint32_t> number(tile.own_count, 0);
  for (const auto& edge : border.edges) {
    for (const std::uint32_t vertex : edge)
      number[vertex] = 1;
  }
  for (std::uint32_t vertex = 0; vertex < tile.own_count; ++vertex) {
    if (number[vertex] == 0 && vertex >= tile.rim_count)
      continue;
    number[vertex] = static_cast<std::uint32_t>(border.positions.size());
    border.positions.push_back(tile.vertices.positions[vertex]);
  }
  for (auto& [a, b] : border.edges) {
    a = number[a];
    b = number[b];
  }
  return border;
}

/// Segments of numbered points: first the vertices by sector and index, then the points of sector
/// lines by key. Needs the vertices first, then the pieces of lines, then the crossing borders.
class Network {
 public:
  /// `borders`: by ascending sector.
  explicit Network(std::span<const SectorBorder* const> borders) {
    for (const SectorBorder* border : borders) {
      const std::uint32_t base = count();
      sectors_.push_back({border->sector, border->rim_count, base});
      positions_.insert(positions_.end(), border->positions.begin(), border->positions.end());
      for (const auto& [a, b] : border->edges)
        segments_.push_back({base + a, base + b});
    }
    vertex_count_ = count();
  }

  void add_lines(std::span<const LinePiece> pieces) {
    struct End {
      const Point* point;
      std::uint32_t number;  ///< of the piece's two ends
    };
    std::vector<End> ends;
    ends.reserve(2 * pieces.size());
    for (const LinePiece& piece : pieces) {
      for (const Point* point : {&piece.a, &piece.b})
        ends.push_back({point, static_cast<std::uint32_t>(ends.size())});
    }
    std::sort(ends.begin(), ends.end(),
              [](const End& x, const End& y) { return x.point->key < y.point->key; });
    std::vector<std::uint32_t> node(ends.size());
    for (const auto& [point, number] : ends) {
      if (keys_.empty() || keys_.back() != point->key) {
        keys_.push_back(point->key);
        positions_.push_back(point->position);
      }
      node[number] = count() - 1;
    }
    for (std::size_t i = 0; i < node.size(); i += 2)
      segments_.push_back({node[i], node[i + 1]});
  }

  void add_crossing_borders(std::span<const CornerEdge> edges) {
    for (const CornerEdge& edge : edges) {
      const std::uint32_t middle = number_of(midpoint(edge));
      segments_.push_back({number_of(edge[0].key), middle});
      segments_.push_back({number_of(edge[1].key), middle});
    }
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(positions_.size()); }
  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const std::array<std::uint32_t, 2>> segments() const { return segments_; }

 private:
  struct Sector {
    std::uint32_t sector, rim_count, base;
  };

  std::uint32_t number_of(const Point& point) const {
    const auto found = std::lower_bound(keys_.begin(), keys_.end(), point.key);
    return vertex_count_ + static_cast<std::uint32_t>(found - keys_.begin());
  }

  /// Of a vertex that a border triangle uses: its sector's rim has it.
  std::uint32_t number_of(VertexKey vertex) const {
    const auto found =
        std::lower_bound(sectors_.begin(), sectors_.end(), sector_of(vertex),
                         [](const Sector& s, std::uint32_t sector) { return s.sector < sector; });
    const auto index = static_cast<std::uint32_t>(vertex);
    if (found != sectors_.end() && found->sector == sector_of(vertex) && index < found->rim_count) {
      return found->base + index;
    }
    throw Error(ErrorCode::internal,
                "outline: a border triangle uses vertex " + std::to_string(index) + " of sector " +
                    std::to_string(sector_of(vertex)) + ", which is not in that sector's rim");
  }

  std::vector<Sector> sectors_;
  std::vector<Vec3f> positions_;
  std::vector<std::array<std::uint32_t, 2>> segments_;
  std::uint32_t vertex_count_ = 0;
  std::vector<std::array<VertexKey, 3>> keys_;  ///< of the points after the vertices
};

/// All chains with the significance of their points, to be cut to any tolerance.
class Lines {
 public:
  /// `least`: the smallest tolerance that will be asked for, input units. `network` must outlive
  /// it.
  Lines(const Network& network, double least)
      : positions_(network.positions()),
        chains_(trace_chains(network.count(), network.segments())) {
    significance_.reserve(chains_.nodes.size());
    for (std::size_t chain = 0; chain < chains_.size(); ++chain) {
      const std::span<const std::uint32_t> nodes = chains_[chain];
      const std::vector<Vec3f> points = points_of(chain);
      const std::vector<double> values = significance(points, nodes.front() == nodes.back(), least);
      lengths_.push_back(length_of(points));
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
        outline.vertices.push_back(positions_[chains_.nodes[i]]);
    }
    outline.starts.push_back(static_cast<std::uint32_t>(outline.vertices.size()));
  }

  /// Before simplification, input units.
  double length(std::size_t chain) const { return lengths_[chain]; }

  /// Chains by length, the longest first, equal ones in order.
  std::vector<std::uint32_t> by_length() const {
    std::vector<std::uint32_t> order(size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
      return lengths_[a] > lengths_[b];
    });
    return order;
  }

 private:
  std::vector<Vec3f> points_of(std::size_t chain) const {
    std::vector<Vec3f> points;
    points.reserve(chains_[chain].size());
    for (const std::uint32_t node : chains_[chain])
      points.push_back(positions_[node]);
    return points;
  }

  std::span<const Vec3f> positions_;
  Chains chains_;
  std::vector<double> significance_;  ///< of chains_.nodes
  std::vector<double> lengths_;       ///< of the chains
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

/// How many of `order` fit with a tolerance in input units.
std::size_t count_that_fit(const Lines& lines, std::span<const std::uint32_t> order,
                           const OutlineOptions& options, double tolerance) {
  std::size_t vertices = 0, count = 0;
  for (; count < order.size(); ++count) {
    vertices += lines.vertex_count(order[count], tolerance);
    if (!fits(options, vertices, count + 1))
      break;
  }
  return count;
}

/// The finest tolerance with which all but specks fit; then whatever fits, the longest first.
Selection select(const Lines& lines, const OutlineOptions& options) {
  const std::vector<std::uint32_t> order = lines.by_length();
  for (double tolerance = options.tolerance;;
       tolerance = std::min(2 * tolerance, kCoarsestTolerance)) {
    const double distance = tolerance * options.diagonal;
    const std::size_t count = count_that_fit(lines, order, options, distance);
    const bool only_specks_left =
        count == order.size() || lines.length(order[count]) < kSpeckLength * distance;
    if (!only_specks_left && tolerance < kCoarsestTolerance)
      continue;
    Selection result{{order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count)},
                     tolerance};
    std::sort(result.chains.begin(), result.chains.end());
    return result;
  }
}

}  // namespace

struct OutlineBuilder::Sector::Content {
  std::vector<CornerTriangle> triangles;  ///< border triangles of which it is the first, sorted
  SectorBorder border;
};

OutlineBuilder::Sector::Sector(std::uint32_t index, const TileMesh& tile)
    : content_(new Content{{}, border_of(index, tile)}) {
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
      content_->triangles.push_back(triangle);
  }
  std::sort(content_->triangles.begin(), content_->triangles.end(), before<3>);
}

OutlineBuilder::Sector::Sector(Sector&&) noexcept = default;
OutlineBuilder::Sector& OutlineBuilder::Sector::operator=(Sector&&) noexcept = default;
OutlineBuilder::Sector::~Sector() = default;

struct OutlineBuilder::Parts {
  std::vector<Sector::Content> sectors;
  std::size_t edge_count = 0;
};

OutlineBuilder::OutlineBuilder() : parts_(std::make_unique<Parts>()) {}
OutlineBuilder::OutlineBuilder(OutlineBuilder&&) noexcept = default;
OutlineBuilder& OutlineBuilder::operator=(OutlineBuilder&&) noexcept = default;
OutlineBuilder::~OutlineBuilder() = default;

void OutlineBuilder::add(Sector sector) {
  parts_->edge_count += sector.content_->triangles.size() + sector.content_->border.edges.size();
  parts_->sectors.push_back(std::move(*sector.content_));
}

std::size_t OutlineBuilder::edge_count() const {
  return parts_->edge_count;
}

OutlineResult OutlineBuilder::finish(const OutlineOptions& options) const {
  assert(options.tolerance > 0 && options.diagonal >= 0);
  std::vector<const Sector::Content*> sectors;
  for (const Sector::Content& sector : parts_->sectors)
    sectors.push_back(&sector);
  std::sort(sectors.begin(), sectors.end(),
            [](const auto* a, const auto* b) { return a->border.sector < b->border.sector; });
  std::vector<const SectorBorder*> borders;
  std::vector<CornerTriangle> triangles;  // sorted: those of a sector come before the next one's
  for (const Sector::Content* sector : sectors) {
    borders.push_back(&sector->border);
    triangles.insert(triangles.end(), sector->triangles.begin(), sector->triangles.end());
  }

  Network network(borders);
  network.add_lines(sector_lines(triangles));
  network.add_crossing_borders(crossing_borders(triangles));
  const Lines lines(network, options.tolerance * options.diagonal);
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
