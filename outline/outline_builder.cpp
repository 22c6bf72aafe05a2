#include "outline/outline_builder.h"

#include "hierarchy/error.h"
#include "outline/polyline.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::outline {
namespace {

/// A vertex over all tiles: tile << 32 | index in it.
using VertexKey = std::uint64_t;

std::uint32_t tile_of(VertexKey vertex) {
  return static_cast<std::uint32_t>(vertex >> 32);
}

struct Corner {
  VertexKey key;
  Vec3f position;
  std::uint32_t part;  ///< of the tile
};

bool in_one_sector(const Corner& a, const Corner& b) {
  return tile_of(a.key) == tile_of(b.key) && a.part == b.part;
}

/// Corners by ascending key: both sides of a line compute its points from the same order.
using PlacedTriangle = std::array<Corner, 3>;

/// Of a triangle's edges, which corners they join.
constexpr std::array<std::array<std::size_t, 2>, 3> kEdges{{{0, 1}, {0, 2}, {1, 2}}};

bool is_crossing(const PlacedTriangle& t, std::size_t edge) {
  return !in_one_sector(t[kEdges[edge][0]], t[kEdges[edge][1]]);
}

bool touches_three(const PlacedTriangle& t) {
  return is_crossing(t, 0) && is_crossing(t, 1) && is_crossing(t, 2);
}

bool touches_one(const PlacedTriangle& t) {
  return !is_crossing(t, 0) && !is_crossing(t, 1);
}

Triangle<VertexKey> key_of(const PlacedTriangle& t) {
  return {t[0].key, t[1].key, t[2].key};
}

bool before(const PlacedTriangle& a, const PlacedTriangle& b) {
  return key_of(a) < key_of(b);
}

/// Pairs of vertices: (lower, higher).
using Edges = std::vector<std::array<std::uint32_t, 2>>;

/// Of a tile's edges between own vertices. All their triangles are in the tile, as interior or
/// border triangles.
struct OwnEdges {
  Edges borders;  ///< exactly one triangle has them
  Edges creases;  ///< exactly two have them, which meet at an angle
};

/// Where two triangles turn by more than 45 degrees, the surface has an edge, not a bend.
constexpr double kCreaseCosine = 0.7071067811865476;

/// An edge of a triangle.
struct Side {
  const TileTriangle* triangle = nullptr;
  bool is_ascending = true;  ///< from the lower vertex to the higher one
};

bool meet_at_an_angle(const TileMesh& tile, const Side& a, const Side& b) {
  const auto normal = [&](const TileTriangle& t) {
    const auto at = [&](std::size_t i) { return to_double(tile.vertices.positions[raw(t[i])]); };
    return cross(at(1) - at(0), at(2) - at(0));
  };
  const Vec3d n = normal(*a.triangle);
  // Neighbours that face alike have their common edge in opposite directions.
  const Vec3d m = normal(*b.triangle) * (a.is_ascending == b.is_ascending ? -1 : 1);
  const double sizes = length(n) * length(m);
  return sizes > 0 && std::isfinite(sizes) && dot(n, m) < kCreaseCosine * sizes;
}

/// By counting sort: O(triangles) where vertices have bounded degree.
OwnEdges own_edges(const TileMesh& tile) {
  struct End {
    std::uint32_t high = 0;
    Side side{};
    bool operator<(const End& other) const { return high < other.high; }
  };
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
            visit(low, End{high, {&t, a < b}});
        }
      }
    }
  };
  visit_edges([&](std::uint32_t low, const End&) { ++first[low + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<End> ends(first.back());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  visit_edges([&](std::uint32_t low, const End& end) { ends[next[low]++] = end; });

  OwnEdges edges;
  for (std::uint32_t low = 0; low < tile.own_count; ++low) {
    const auto begin = ends.begin() + first[low], end = ends.begin() + first[low + 1];
    std::sort(begin, end);
    for (auto run = begin; run != end;) {
      const auto run_end = std::upper_bound(run, end, *run);
      if (run_end - run == 1)
        edges.borders.push_back({low, run->high});
      else if (run_end - run == 2 && meet_at_an_angle(tile, run->side, run[1].side))
        edges.creases.push_back({low, run->high});
      run = run_end;
    }
  }
  return edges;
}

/// A tile's part of the mesh's own borders and creases, small for soups that are nothing but
/// borders: the boundary (where crossing borders end), then the other vertices on own borders and
/// creases, ascending.
struct TileLines {
  std::uint32_t tile = 0;
  std::uint32_t boundary_count = 0;
  std::vector<std::uint32_t> inner;  ///< of the other vertices, which they are
  std::vector<Vec3f> positions;
  Edges borders, creases;  ///< of positions, without those that cross from sector to sector
};

/// `is_crossing(a, b)`: of own vertices.
template <class IsCrossing>
TileLines lines_of(std::uint32_t tile_index, const TileMesh& tile, const IsCrossing& is_crossing) {
  OwnEdges edges = own_edges(tile);
  std::vector<std::uint32_t> number(tile.own_count, 0);
  for (const Edges* list : {&edges.borders, &edges.creases}) {
    for (const auto& [a, b] : *list)
      number[a] = number[b] = 1;
  }
  TileLines lines{tile_index, tile.boundary_count, {}, {}, {}, {}};
  for (std::uint32_t vertex = 0; vertex < tile.own_count; ++vertex) {
    if (number[vertex] == 0 && vertex >= tile.boundary_count)
      continue;
    if (vertex >= tile.boundary_count)
      lines.inner.push_back(vertex);
    number[vertex] = static_cast<std::uint32_t>(lines.positions.size());
    lines.positions.push_back(tile.vertices.positions[vertex]);
  }
  const auto keep = [&](const Edges& from, Edges& to) {
    for (const auto& [a, b] : from) {
      if (!is_crossing(a, b))
        to.push_back({number[a], number[b]});
    }
  };
  keep(edges.borders, lines.borders);
  keep(edges.creases, lines.creases);
  return lines;
}

struct SectorContent {
  /// Those in several sectors, sorted; of those in several tiles if it is the first.
  std::vector<PlacedTriangle> triangles;
  TileLines lines;
};

/// Segments of numbered points: first the vertices by tile and index, then the points of sector
/// lines by the corners they lie between: an edge's midpoint (a, b, b), a triangle's centroid
/// (a, b, c).
class Network {
 public:
  /// Takes what tiles hold, by ascending tile, and leaves nothing there. Without the segments.
  explicit Network(std::span<SectorContent*> sectors) {
    std::size_t triangle_count = 0, edge_count = 0;
    for (const SectorContent* sector : sectors) {
      triangle_count += sector->triangles.size();
      edge_count += sector->lines.borders.size();
    }
    triangles_.reserve(triangle_count);
    segments_.reserve(edge_count);
    for (SectorContent* sector : sectors) {
      triangles_.insert(triangles_.end(), sector->triangles.begin(), sector->triangles.end());
      add_lines(sector->lines);
      *sector = {};
    }
    vertex_count_ = count();
    number_points();
  }

  /// How many there will be.
  std::size_t segment_count() const {
    std::size_t count = segments_.size() + creases_.size() + 2 * lonely_.size();
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      count += is_repeated(t) ? 0U : touches_three(triangles_[t]) ? 3U : 1U;
    return count;
  }

  void make_segments() {
    segments_.reserve(segment_count() - creases_.size());
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
  std::span<const std::array<std::uint32_t, 2>> creases() const { return creases_; }

 private:
  struct Tile {
    std::uint32_t tile, boundary_count, base;
    std::vector<std::uint32_t> inner;
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

  void add_lines(TileLines& lines) {
    const std::uint32_t base = count();
    tiles_.push_back({lines.tile, lines.boundary_count, base, std::move(lines.inner)});
    positions_.insert(positions_.end(), lines.positions.begin(), lines.positions.end());
    for (const auto& [a, b] : lines.borders)
      segments_.push_back({base + a, base + b});
    for (const auto& [a, b] : lines.creases)
      creases_.push_back({base + a, base + b});
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

  /// Of a vertex on the mesh's border that a triangle in several sectors uses.
  std::uint32_t number_of(VertexKey vertex) const {
    const auto found =
        std::lower_bound(tiles_.begin(), tiles_.end(), tile_of(vertex),
                         [](const Tile& t, std::uint32_t tile) { return t.tile < tile; });
    const auto index = static_cast<std::uint32_t>(vertex);
    if (found != tiles_.end() && found->tile == tile_of(vertex)) {
      if (index < found->boundary_count)
        return found->base + index;
      const auto inner = std::lower_bound(found->inner.begin(), found->inner.end(), index);
      if (inner != found->inner.end() && *inner == index)
        return found->base + found->boundary_count +
               static_cast<std::uint32_t>(inner - found->inner.begin());
    }
    throw Error(ErrorCode::internal,
                "outline: a border triangle uses vertex " + std::to_string(index) + " of tile " +
                    std::to_string(tile_of(vertex)) + ", which is not in that tile's boundary");
  }

  static constexpr Triangle<VertexKey> kAfterAll{~VertexKey{0}, ~VertexKey{0}, ~VertexKey{0}};

  std::vector<Tile> tiles_;
  std::vector<Vec3f> positions_;
  Edges segments_, creases_;
  std::uint32_t vertex_count_ = 0;
  // Until segments are made:
  std::vector<PlacedTriangle> triangles_;  ///< sorted: a sector's come before the next one's
  std::vector<Points> points_;             ///< of each triangle
  std::vector<CrossingEdge> lonely_;       ///< ascending
};

/// All chains with the significance of their points, to be cut to any tolerance.
class Lines {
 public:
  /// `least`: the smallest tolerance that will be asked for, `crease`: creases that are shorter are
  /// left out; both in input units. `network` must outlive it.
  Lines(const Network& network, double least, double crease)
      : positions_(network.positions()),
        chains_(trace_chains(network.count(), network.segments())) {
    add_long_ones(trace_chains(network.count(), network.creases()), crease);
    significance_.reserve(chains_.nodes.size());
    for (std::size_t chain = 0; chain < chains_.size(); ++chain) {
      const std::span<const std::uint32_t> nodes = chains_[chain];
      const std::vector<Vec3f> points = points_of(nodes);
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
  std::vector<Vec3f> points_of(std::span<const std::uint32_t> nodes) const {
    std::vector<Vec3f> points;
    points.reserve(nodes.size());
    for (const std::uint32_t node : nodes)
      points.push_back(positions_[node]);
    return points;
  }

  void add_long_ones(const Chains& creases, double least) {
    for (std::size_t chain = 0; chain < creases.size(); ++chain) {
      if (length_of(points_of(creases[chain])) < least)
        continue;
      chains_.nodes.insert(chains_.nodes.end(), creases[chain].begin(), creases[chain].end());
      chains_.starts.push_back(static_cast<std::uint32_t>(chains_.nodes.size()));
    }
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

OutlineBuilder::Sector::Sector(std::uint32_t index, const TileMesh& tile, const Sectors& sectors)
    : content_(new Content) {
  const auto part = [&](std::uint32_t owner, std::uint32_t own) -> std::uint32_t {
    return sectors.empty() ? 0 : sectors.at(owner).at(own);
  };
  const auto corner = [&](std::uint32_t vertex) -> Corner {
    const TileVertex v{vertex};
    const std::uint32_t owner = tile.is_own(v) ? index : tile.ghost(v).tile;
    const std::uint32_t own = tile.is_own(v) ? vertex : tile.ghost(v).index;
    return {VertexKey{owner} << 32 | own, tile.vertices.positions[vertex], part(owner, own)};
  };
  content_->lines = lines_of(index, tile, [&](std::uint32_t a, std::uint32_t b) {
    return !in_one_sector(corner(a), corner(b));
  });
  for (const std::vector<TileTriangle>* triangles : {&tile.interior, &tile.border}) {
    for (const TileTriangle& t : *triangles) {
      if (is_degenerate(t))
        continue;
      PlacedTriangle triangle = {corner(raw(t[0])), corner(raw(t[1])), corner(raw(t[2]))};
      std::sort(triangle.begin(), triangle.end(),
                [](const Corner& a, const Corner& b) { return a.key < b.key; });
      // Every tile it touches has it; the lowest brings it.
      if (tile_of(triangle[0].key) == index && !touches_one(triangle))
        content_->triangles.push_back(triangle);
    }
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
  parts_->edge_count += sector.content_->triangles.size() + sector.content_->lines.borders.size() +
                        sector.content_->lines.creases.size();
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
            [](const auto* a, const auto* b) { return a->lines.tile < b->lines.tile; });
  Network network(sectors);
  if (network.segment_count() > options.max_segments)
    return std::nullopt;
  network.make_segments();
  const Lines lines(network, options.tolerance * options.diagonal,
                    kShortestCrease * options.diagonal);
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
