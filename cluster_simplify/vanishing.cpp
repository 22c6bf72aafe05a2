#include "cluster_simplify/vanishing.h"

#include "base/union_find.h"
#include "cluster_simplify/nearest.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace meshhier::cluster_simplify {
namespace {

// A level halves the vertices; what is larger cannot be down to nothing at its end unless it is
// worth next to nothing.
constexpr std::uint32_t kSmallPiece = 32;

/// Returns, for each vertex, the least vertex of its connected piece.
std::vector<std::uint32_t> piece_of_vertices(const TileMesh& tile) {
  const auto count = static_cast<std::uint32_t>(tile.vertices.size());
  UnionFind pieces(count);
  for (const auto* triangles : {&tile.interior, &tile.border}) {
    for (const TileTriangle& t : *triangles) {
      pieces.join(raw(t[0]), raw(t[1]));
      pieces.join(raw(t[0]), raw(t[2]));
    }
  }
  std::vector<std::uint32_t> piece_of(count);
  for (std::uint32_t v = 0; v < count; ++v)
    piece_of[v] = pieces.find(v);
  return piece_of;
}

/// For each vertex of `small`, the place that is left near it where its piece was: of a larger
/// piece the nearest vertex, or without any the middle of its own piece.
std::vector<Vec3f> places_left(std::span<const Vec3f> positions,
                               std::span<const std::uint32_t> small,
                               std::span<const std::uint32_t> large,
                               std::span<const std::uint32_t> pieces,
                               std::span<const std::uint32_t> sizes) {
  std::vector<Vec3f> left;
  left.reserve(small.size());
  if (!large.empty()) {
    for (const std::uint32_t v : nearest_of(positions, large, small))
      left.push_back(positions[v]);
    return left;
  }
  std::vector<Vec3f> middles(positions.size());
  for (const std::uint32_t v : small)
    middles[pieces[v]] =
        middles[pieces[v]] + positions[v] * (1 / static_cast<float>(sizes[pieces[v]]));
  for (const std::uint32_t v : small)
    left.push_back(middles[pieces[v]]);
  return left;
}

}  // namespace

std::vector<float> vanishing_distances(const TileMesh& tile, std::span<const Vec3f> positions) {
  const std::vector<std::uint32_t> pieces = piece_of_vertices(tile);
  const auto count = static_cast<std::uint32_t>(pieces.size());
  std::vector<std::uint32_t> sizes(count);
  std::vector<char> has_ghost(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    ++sizes[pieces[v]];
    has_ghost[pieces[v]] |= static_cast<char>(v >= tile.own_count);
  }
  const auto is_large = [&](std::uint32_t v) {
    return sizes[pieces[v]] > kSmallPiece || has_ghost[pieces[v]] != 0;
  };
  std::vector<std::uint32_t> small;
  for (std::uint32_t v = 0; v < count; ++v) {
    if (!is_large(v) && sizes[pieces[v]] > 1)  // alone: shows nothing
      small.push_back(v);
  }
  std::vector<float> distances(count, std::numeric_limits<float>::infinity());
  if (small.empty())
    return distances;
  std::vector<std::uint32_t> large;
  for (std::uint32_t v = 0; v < count; ++v) {
    if (is_large(v))
      large.push_back(v);
  }
  const std::vector<Vec3f> left = places_left(positions, small, large, pieces, sizes);
  for (const std::uint32_t v : small)
    distances[v] = 0;
  for (std::size_t i = 0; i < small.size(); ++i) {
    const std::uint32_t piece = pieces[small[i]];
    const Vec3f away = positions[small[i]] - left[i];
    distances[piece] += dot(away, away) / static_cast<float>(sizes[piece]);
  }
  for (const std::uint32_t v : small)
    distances[v] = distances[pieces[v]];
  return distances;
}

}  // namespace meshhier::cluster_simplify
