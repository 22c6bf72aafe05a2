#include "verify/corner_triangle.h"

#include "hierarchy/shown_corners.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <iterator>

namespace meshhier::verifying {
namespace {

const CornerTriangle& corners_of(const CornerTriangle& t) {
  return t;
}
const CornerTriangle& corners_of(const ShadedTriangle& t) {
  return t.corners;
}

void turn(CornerTriangle& t, std::size_t first) {
  t = turned(t, first);
}
void turn(ShadedTriangle& t, std::size_t first) {
  t = {turned(t.corners, first), turned(t.normals, first)};
}

/// Returns the corner that a triangle begins with. smallest_corner() does not tell it where a
/// corner comes twice.
std::size_t first_corner(const CornerTriangle& t) {
  if (!is_degenerate(t))
    return smallest_corner(t);
  const auto less = [&](std::size_t a, std::size_t b) { return turned(t, a) < turned(t, b); };
  return std::min({std::size_t{0}, std::size_t{1}, std::size_t{2}}, less);
}

template <class Cornered>
void normalize_all(std::vector<Cornered>& triangles, bool unique) {
  if (unique)
    std::erase_if(triangles, [](const Cornered& t) { return is_degenerate(corners_of(t)); });
  for (Cornered& t : triangles)
    turn(t, first_corner(corners_of(t)));
  std::sort(triangles.begin(), triangles.end());
  if (!unique)
    return;
  const auto equal = [](const Cornered& a, const Cornered& b) {
    return corners_of(a) == corners_of(b);
  };
  triangles.erase(std::unique(triangles.begin(), triangles.end(), equal), triangles.end());
}

void add_normals(const PublishedTile& tile, std::vector<ShadedTriangle>& border) {
  const std::vector<TileTriangle> numbers = shown_border(tile);
  for (std::size_t t = 0; t < border.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c)
      border[t].normals[c] = std::bit_cast<std::uint32_t>(tile.shading.normals[raw(numbers[t][c])]);
  }
}

}  // namespace

void normalize(std::vector<CornerTriangle>& triangles, bool unique) {
  normalize_all(triangles, unique);
}
void normalize(std::vector<ShadedTriangle>& triangles, bool unique) {
  normalize_all(triangles, unique);
}

std::vector<ShadedTriangle> border_of(const PublishedTile& tile, const Tree& tree) {
  const TileMesh& mesh = tile.mesh;
  std::vector<ShadedTriangle> triangles;
  triangles.reserve(mesh.border.size());
  for (const TileTriangle& t : mesh.border) {
    CornerTriangle& corners = triangles.emplace_back().corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = mesh.is_own(t[i]) ? make_corner(tile.node.index, raw(t[i]))
                                     : make_corner(mesh.ghost(t[i]).tile, mesh.ghost(t[i]).index);
    }
  }
  if (!tile.shading.normals.empty())
    add_normals(tile, triangles);
  // All of the input's triangles stay; simplified tiles have none to drop, or it is told elsewhere.
  normalize(triangles, !tree.is_partition(tile.node));
  return triangles;
}

std::vector<ShadedTriangle> early_border_of(const PublishedTile& tile, const Tree& tree) {
  const TileMesh& mesh = tile.mesh;
  const Level above = coarser(tile.node.level);
  const std::uint32_t own = tree.parent(tile.node).index;
  // No other partition is below the early node, so every chain has an entry for its level.
  const auto corner = [&](TileVertex v) {
    if (mesh.is_own(v))
      return make_corner(own, raw(v));
    const NodeId neighbour{tile.node.level, mesh.ghost(v).tile};
    return make_corner(tree.ancestor(neighbour, above).index,
                       tile.chains[raw(v) - mesh.own_count][1]);
  };
  std::vector<ShadedTriangle> triangles;
  triangles.reserve(mesh.border.size());
  for (const TileTriangle& t : mesh.border) {
    triangles.push_back({{corner(t[0]), corner(t[1]), corner(t[2])}});
  }
  normalize(triangles, true);
  return triangles;
}

}  // namespace meshhier::verifying
