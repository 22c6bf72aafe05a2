#include "outline/tile_lines.h"

#include "outline/tile_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace meshhier::outline {
namespace {

/// Some of a tile's edges between own vertices. All triangles at those are in the tile, as interior
/// or border triangles.
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
    for_each_triangle(tile, [&](const TileTriangle& t) {
      if (is_degenerate(t))
        return;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = raw(t[i]), b = raw(t[(i + 1) % 3]);
        const std::uint32_t low = std::min(a, b), high = std::max(a, b);
        if (high < tile.own_count)
          visit(low, End{high, {&t, a < b}});
      }
    });
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

}  // namespace

TileLines lines_of(std::uint32_t tile_index, const TileMesh& tile,
                   const std::function<bool(std::uint32_t, std::uint32_t)>& is_crossing) {
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
  for (const auto& [a, b] : edges.borders) {
    if (!is_crossing(a, b))
      lines.borders.push_back({number[a], number[b]});
  }
  for (const auto& [a, b] : edges.creases)
    lines.creases.push_back({number[a], number[b]});
  return lines;
}

}  // namespace meshhier::outline
