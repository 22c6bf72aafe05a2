#include "inspection/corner_triangle.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace meshhier::inspection {
void normalize(std::vector<CornerTriangle>& triangles, bool unique) {
  if (unique)
    std::erase_if(triangles, [](const CornerTriangle& t) { return is_degenerate(t); });
  for (CornerTriangle& t : triangles)  // canonical() does not tell where a corner is there twice
    t = is_degenerate(t) ? std::min({t, turned(t, 1), turned(t, 2)}) : canonical(t);
  std::sort(triangles.begin(), triangles.end());
  if (unique)
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

std::vector<CornerTriangle> border_of(const PublishedTile& tile, const Tree& tree) {
  const TileMesh& mesh = tile.mesh;
  std::vector<CornerTriangle> triangles;
  triangles.reserve(mesh.border.size());
  for (const TileTriangle& t : mesh.border) {
    CornerTriangle& corners = triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = mesh.is_own(t[i]) ? make_corner(tile.node.index, raw(t[i]))
                                     : make_corner(mesh.ghost(t[i]).tile, mesh.ghost(t[i]).index);
    }
  }
  // All of the input's triangles stay; simplified tiles have none to drop, or it is told elsewhere.
  normalize(triangles, !tree.is_partition(tile.node));
  return triangles;
}

std::vector<CornerTriangle> early_border_of(const PublishedTile& tile, const Tree& tree) {
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
  std::vector<CornerTriangle> triangles;
  triangles.reserve(mesh.border.size());
  for (const TileTriangle& t : mesh.border) {
    triangles.push_back({corner(t[0]), corner(t[1]), corner(t[2])});
  }
  normalize(triangles, true);
  return triangles;
}

}  // namespace meshhier::inspection
