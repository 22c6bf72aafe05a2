#include "cluster_simplify/vanishing.h"

#include "cluster_simplify/nearest.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

namespace meshhier::cluster_simplify {
namespace {

// A level halves the vertices; what is larger cannot be down to nothing at its end unless it is
// worth next to nothing.
constexpr std::uint32_t kSmallPiece = 32;

/// Of each vertex, the highest vertex of its connected piece; ghosts come last.
std::vector<std::uint32_t> piece_of_vertices(const CollapseMesh& mesh) {
  std::vector<std::uint32_t> above(mesh.vertex_count());
  std::iota(above.begin(), above.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (above[v] != v) {
      above[v] = above[above[v]];
      v = above[v];
    }
    return v;
  };
  // From the last edge: edges come by their lower vertices, so most meet a piece that is known.
  for (std::size_t e = mesh.edges().size(); e-- > 0;) {
    const CollapseMesh::Edge& edge = mesh.edges()[e];
    if (above[edge.a] == above[edge.b])
      continue;
    const std::uint32_t a = find(edge.a);
    const std::uint32_t b = find(edge.b);
    above[std::min(a, b)] = std::max(a, b);
  }
  for (std::uint32_t v = mesh.vertex_count(); v-- > 0;)
    above[v] = above[above[v]];  // what is above has its piece already
  return above;
}

}  // namespace

std::vector<float> vanishing_distances(const CollapseMesh& mesh, std::span<const Vec3f> positions) {
  const std::vector<std::uint32_t> pieces = piece_of_vertices(mesh);
  std::vector<std::uint32_t> sizes(mesh.vertex_count());
  for (const std::uint32_t piece : pieces)
    ++sizes[piece];
  const auto is_large = [&](std::uint32_t v) {
    return sizes[pieces[v]] > kSmallPiece || pieces[v] >= mesh.own_count();
  };
  std::vector<std::uint32_t> small;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!is_large(v) && sizes[pieces[v]] > 1)  // alone: shows nothing
      small.push_back(v);
  }
  std::vector<float> distances(mesh.vertex_count(), std::numeric_limits<float>::infinity());
  if (small.empty())
    return distances;
  std::vector<std::uint32_t> large;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (is_large(v))
      large.push_back(v);
  }
  if (large.empty())
    return distances;
  const std::vector<std::uint32_t> nearest = nearest_of(positions, large, small);
  for (const std::uint32_t v : small)
    distances[v] = 0;
  for (std::size_t i = 0; i < small.size(); ++i) {
    const std::uint32_t piece = pieces[small[i]];
    const Vec3f away = positions[small[i]] - positions[nearest[i]];
    distances[piece] += dot(away, away) / static_cast<float>(sizes[piece]);
  }
  for (const std::uint32_t v : small)
    distances[v] = distances[pieces[v]];
  return distances;
}

}  // namespace meshhier::cluster_simplify
