#include "outline/network.h"

#include "base/error.h"

#include <algorithm>
#include <string>
#include <utility>

namespace meshhier::outline {
namespace {

constexpr Triangle<VertexKey> kAfterAll{~VertexKey{0}, ~VertexKey{0}, ~VertexKey{0}};

}  // namespace

Network::Network(std::span<SectorContent*> sectors) {
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
  number_points();
}

std::size_t Network::segment_count() const {
  std::size_t count = segments_.size() + forms_.size() + 2 * lonely_.size();
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    count += is_repeated(t) ? 0U : touches_three(triangles_[t]) ? 3U : 1U;
  return count;
}

void Network::make_segments() {
  segments_.reserve(segment_count() - forms_.size());
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

void Network::add_form(std::span<const Vec3f> points) {
  const bool closed = points.front() == points.back();
  const std::uint32_t base = count();
  const auto fresh = static_cast<std::uint32_t>(points.size() - (closed ? 1 : 0));
  positions_.insert(positions_.end(), points.begin(), points.begin() + fresh);
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i)
    forms_.push_back({base + i, base + (i + 1) % fresh});
}

void Network::add_lines(TileLines& lines) {
  const std::uint32_t base = count();
  tiles_.push_back({lines.tile, lines.boundary_count, base, std::move(lines.inner)});
  positions_.insert(positions_.end(), lines.positions.begin(), lines.positions.end());
  for (const auto& [a, b] : lines.borders)
    segments_.push_back({base + a, base + b});
  for (const auto& [a, b] : lines.creases)
    forms_.push_back({base + a, base + b});
}

std::vector<Network::CrossingEdge> Network::crossing_edges() const {
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

bool Network::is_repeated(std::size_t t) const {
  return t > 0 && key_of(triangles_[t - 1]) == key_of(triangles_[t]);
}

void Network::number_points() {
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

std::uint32_t Network::add_midpoint(const PlacedTriangle& t, std::size_t edge) {
  const auto& [a, b] = kEdges[edge];
  const Vec3d sum = to_double(t[a].position) + to_double(t[b].position);
  positions_.push_back(to_float(sum * 0.5));
  return count() - 1;
}

std::uint32_t Network::add_centroid(const PlacedTriangle& t) {
  const Vec3d sum = to_double(t[0].position) + to_double(t[1].position) + to_double(t[2].position);
  positions_.push_back(to_float(sum * (1.0 / 3)));
  return count() - 1;
}

void Network::add_line(const PlacedTriangle& triangle, const Points& points) {
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

std::uint32_t Network::number_of(VertexKey vertex) const {
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

}  // namespace meshhier::outline
