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
using PlacedTriangle = std::array<Corner, 3>;

/// Of a triangle's edges, which corners they join.
constexpr std::array<std::array<std::size_t, 2>, 3> kEdges{{{0, 1}, {0, 2}, {1, 2}}};

bool is_crossing(const PlacedTriangle& t, std::size_t edge) {
  return sector_of(t[kEdges[edge][0]].key) != sector_of(t[kEdges[edge][1]].key);
}

bool touches_three(const PlacedTriangle& t) {
  return is_crossing(t, 0) && is_crossing(t, 2);  // corners ascend by sector
}

Triangle<VertexKey> key_of(const PlacedTriangle& t) {
  return {t[0].key, t[1].key, t[2].key};
}

bool before(const PlacedTriangle& a, const PlacedTriangle& b) {
  return key_of(a) < key_of(b);
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
    for (const std::vector<TileTriangle>* triangles : {&tile.interior, &tile.border}) {
      for (const TileTriangle& t : *triangles) {
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

/// A sector's part of the mesh's own borders, small for soups that are nothing but borders: the
/// boundary (where crossing borders end), then the other vertices on own border edges, ascending.
struct SectorBorder {
  std::uint32_t sector = 0;
  std::uint32_t boundary_count = 0;
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< of positions
};

SectorBorder border_of(std::uint32_t sector, const TileMesh& tile) {
  SectorBorder border{sector, tile.boundary_count, {}, own_border_edges(tile)};
  std::vector<std::uint32_t> number(tile.own_count, 0);
  for (const auto& edge : border.edges) {
    for (const std::uint32_t vertex : edge)
      number[vertex] = 1;
  }
  for (std::uint32_t vertex = 0; vertex < tile.own_count; ++vertex) {
    if (number[vertex] == 0 && vertex >= tile.boundary_count)
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

struct SectorContent {
  std::vector<PlacedTriangle> triangles;  ///< border triangles of which it is the first, sorted
  SectorBorder border;
};

/// Segments of numbered points: first the vertices by sector and index, then the points of sector
/// lines by the corners they lie between: an edge's midpoint (a, b, b), a triangle's centroid
/// (a, b, c).
class Network {
 public:
  /// Takes what sectors hold, by ascending sector, and leaves nothing there. Without the segments.
  explicit Network(std::span<SectorContent*> sectors) {
    std::size_t triangle_count = 0, edge_count = 0;
    for (const SectorContent* sector : sectors) {
      triangle_count += sector->triangles.size();
      edge_count += sector->border.edges.size();
    }
    triangles_.reserve(triangle_count);
    segments_.reserve(edge_count);
    for (SectorContent* sector : sectors) {
      triangles_.insert(triangles_.end(), sector->triangles.begin(), sector->triangles.end());
      add_border(sector->border);
      *sector = {};
    }
    vertex_count_ = count();
    number_points();
  }

  /// How many there will be.
  std::size_t segment_count() const {
    std::size_t count = segments_.size() + 2 * lonely_.size();
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      count += is_repeated(t) ? 0U : touches_three(triangles_[t]) ? 3U : 1U;
    return count;
  }

  void make_segments() {
    segments_.reserve(segment_count());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (!is_repeated(t))
        add_line(triangles_[t], points_[t]);
    }
    // Crossing edges that exactly one triangle has.
    for (const auto& [low, high, place] : lonely_) {
      const std::uint32_t middle = points_[place / 3].middles[place % 3];
      segments_.push_back({number_of(low), middle});
      segments_.push_back({number_of(high), middle});
    }
    triangles_ = {};
    points_ = {};
    lonely_ = {};
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(positions_.size()); }
  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const std::array<std::uint32_t, 2>> segments() const { return segments_; }

 private:
  struct Sector {
    std::uint32_t sector, boundary_count, base;
  };
  /// Numbers of a triangle's points, as far as it has them.
  struct Points {
    std::array<std::uint32_t, 3> middles;
    std::uint32_t centroid;
  };
  /// An edge between two sectors, as one triangle has it.
  struct CrossingEdge {
    VertexKey low, high;
    std::uint32_t place;  ///< triangle * 3 + edge
    friend constexpr auto operator<=>(const CrossingEdge&, const CrossingEdge&) = default;
  };

  void add_border(const SectorBorder& border) {
    const std::uint32_t base = count();
    sectors_.push_back({border.sector, border.boundary_count, base});
    positions_.insert(positions_.end(), border.positions.begin(), border.positions.end());
    for (const auto& [a, b] : border.edges)
      segments_.push_back({base + a, base + b});
  }

  std::vector<CrossingEdge> crossing_edges() const {
    std::vector<CrossingEdge> edges;
    edges.reserve(3 * triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (std::uint32_t e = 0; e < 3; ++e) {
        const auto& [a, b] = kEdges[e];
        if (is_crossing(triangles_[t], e))
          edges.push_back({triangles_[t][a].key, triangles_[t][b].key, 3 * t + e});
      }
    }
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  /// A triangle and its duplicates or mirror images make one line.
  bool is_repeated(std::size_t t) const {
    return t > 0 && key_of(triangles_[t - 1]) == key_of(triangles_[t]);
  }

  void number_points() {
    points_.resize(triangles_.size());
    const std::vector<CrossingEdge> edges = crossing_edges();
    std::size_t t = 0;
    const auto add_centroids_before = [&](const Triangle<VertexKey>& key) {
      for (; t < triangles_.size() && key_of(triangles_[t]) < key; ++t) {
        if (touches_three(triangles_[t]) && !is_repeated(t))
          points_[t].centroid = add_centroid(triangles_[t]);
      }
    };
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
      const auto& [low, high, place] = edges[first];
      add_centroids_before({low, high, high});
      const std::uint32_t number = add_midpoint(triangles_[place / 3], place % 3);
      for (; last < edges.size() && edges[last].low == low && edges[last].high == high; ++last)
        points_[edges[last].place / 3].middles[edges[last].place % 3] = number;
      if (last - first == 1)
        lonely_.push_back({low, high, place});
    }
    add_centroids_before(kAfterAll);
  }

  std::uint32_t add_midpoint(const PlacedTriangle& t, std::size_t edge) {
    const auto& [a, b] = kEdges[edge];
    const Vec3d sum = to_double(t[a].position) + to_double(t[b].position);
    positions_.push_back(to_float(sum * 0.5));
    return count() - 1;
  }

  std::uint32_t add_centroid(const PlacedTriangle& t) {
    const Vec3d sum =
        to_double(t[0].position) + to_double(t[1].position) + to_double(t[2].position);
    positions_.push_back(to_float(sum * (1.0 / 3)));
    return count() - 1;
  }

  /// The line through one border triangle, which has two or three crossing edges.
  void add_line(const PlacedTriangle& triangle, const Points& points) {
    std::array<std::uint32_t, 3> crossings{};
    std::size_t count = 0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      if (is_crossing(triangle, edge))
        crossings[count++] = points.middles[edge];
    }
    if (count == 2)
      return segments_.push_back({crossings[0], crossings[1]});
    for (const std::uint32_t crossing : crossings)
      segments_.push_back({crossing, points.centroid});
  }

  /// Of a vertex that a border triangle uses: its sector's boundary has it.
  std::uint32_t number_of(VertexKey vertex) const {
    const auto found =
        std::lower_bound(sectors_.begin(), sectors_.end(), sector_of(vertex),
                         [](const Sector& s, std::uint32_t sector) { return s.sector < sector; });
    const auto index = static_cast<std::uint32_t>(vertex);
    if (found != sectors_.end() && found->sector == sector_of(vertex) &&
        index < found->boundary_count) {
      return found->base + index;
    }
    throw Error(ErrorCode::internal,
                "outline: a border triangle uses vertex " + std::to_string(index) + " of sector " +
                    std::to_string(sector_of(vertex)) + ", which is not in that sector's boundary");
  }

  static constexpr Triangle<VertexKey> kAfterAll{~VertexKey{0}, ~VertexKey{0}, ~VertexKey{0}};

  std::vector<Sector> sectors_;
  std::vector<Vec3f> positions_;
  std::vector<std::array<std::uint32_t, 2>> segments_;
  std::uint32_t vertex_count_ = 0;
  // Until segments are made:
  std::vector<PlacedTriangle> triangles_;  ///< sorted: a sector's come before the next one's
  std::vector<Points> points_;             ///< of each triangle
  std::vector<CrossingEdge> lonely_;       ///< ascending
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

struct OutlineBuilder::Sector::Content : SectorContent {};

OutlineBuilder::Sector::Sector(std::uint32_t index, const TileMesh& tile)
    : content_(new Content{{{}, border_of(index, tile)}}) {
  const auto corner = [&](std::uint32_t vertex) -> Corner {
    const TileVertex v{vertex};
    const std::uint32_t sector = tile.is_own(v) ? index : tile.ghost(v).tile;
    const std::uint32_t own = tile.is_own(v) ? vertex : tile.ghost(v).index;
    return {VertexKey{sector} << 32 | own, tile.vertices.positions[vertex]};
  };
  for (const TileTriangle& t : tile.border) {
    if (is_degenerate(t))
      continue;
    PlacedTriangle triangle = {corner(raw(t[0])), corner(raw(t[1])), corner(raw(t[2]))};
    std::sort(triangle.begin(), triangle.end(),
              [](const Corner& a, const Corner& b) { return a.key < b.key; });
    // Every tile it touches has it; the lowest brings it.
    if (sector_of(triangle[0].key) == index)
      content_->triangles.push_back(triangle);
  }
  std::sort(content_->triangles.begin(), content_->triangles.end(), before);
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

std::optional<OutlineResult> OutlineBuilder::finish(const OutlineOptions& options) {
  assert(options.tolerance > 0 && options.diagonal >= 0);
  std::vector<SectorContent*> sectors;
  for (SectorContent& sector : parts_->sectors)
    sectors.push_back(&sector);
  std::sort(sectors.begin(), sectors.end(),
            [](const auto* a, const auto* b) { return a->border.sector < b->border.sector; });
  Network network(sectors);
  if (network.segment_count() > options.max_segments)
    return std::nullopt;
  network.make_segments();
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
