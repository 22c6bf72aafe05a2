// The proof that every cut is seamless, one tile at a time.
//
// All levels show images of the original mesh under maps of places, and the maps of neighbours
// agree (verify_borders). So if the triangles of each simplified tile are the images of its
// children's, then by induction the triangles of every tile are the images of the original ones
// that touch its node; and a cut, which draws each of them once, shows the image of the original
// mesh under one map of places. A closed surface stays closed under any such map.
#include "hierarchy/cut.h"
#include "verify/corner_triangle.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// The tiles of a node's children, one or two.
using ChildTiles = std::vector<std::shared_ptr<const PublishedTile>>;

ChildTiles children_of(const VerifyJob& job, NodeId parent) {
  ChildTiles tiles;
  const Tree::Children children = job.tree().children(parent);
  for (NodeId child : children.span())
    tiles.push_back(job.tiles.find(child));
  return tiles;
}

/// The image of ghost i of `child`, or nothing if its chain is wrong (told by explain_difference).
/// `sibling`: the parent's other child.
std::optional<CornerId> ghost_image(const Tree& tree, const PublishedTile& child,
                                    const PublishedTile& sibling, std::size_t i, NodeId parent) {
  const NodeId neighbour{child.node.level, child.mesh.ghosts[i].tile};
  const std::size_t up = raw(child.node.level) - raw(parent.level);
  const GhostChain chain = child.chains[i];
  const NodeId above = tree.ancestor(neighbour, parent.level);
  if (above != parent) {
    if (up >= chain.size())
      return std::nullopt;
    return make_corner(above.index, chain[up]);
  }
  // A vertex of the other child: the chain ends there, its parent map leads on.
  if (up - 1 >= chain.size() || chain[up - 1] >= sibling.parent_map.size())
    return std::nullopt;
  return make_corner(parent.index, sibling.parent_map[chain[up - 1]]);
}

/// The places of a child's tile as places of the parent's level; nothing if the child is
/// broken.
std::optional<std::vector<CornerId>> image_of_vertices(const Tree& tree, const PublishedTile& child,
                                                       const PublishedTile& sibling,
                                                       NodeId parent) {
  std::vector<CornerId> images;
  images.reserve(child.mesh.vertices.size());
  if (child.parent_map.size() != child.mesh.own_count)
    return std::nullopt;
  for (std::uint16_t vertex : child.parent_map)
    images.push_back(make_corner(parent.index, vertex));
  for (std::size_t i = 0; i < child.mesh.ghosts.size(); ++i) {
    const auto image = ghost_image(tree, child, sibling, i, parent);
    if (!image)
      return std::nullopt;
    images.push_back(*image);
  }
  return images;
}

/// Adds the images of a child's triangles. False if the child is broken, which is told elsewhere.
bool add_image(const Tree& tree, const PublishedTile& child, const PublishedTile& sibling,
               NodeId parent, std::vector<CornerTriangle>& images, std::vector<bool>& reached) {
  const auto corners = image_of_vertices(tree, child, sibling, parent);
  if (!corners)
    return false;
  for (const auto* list : {&child.mesh.interior, &child.mesh.border}) {
    for (const TileTriangle& t : *list) {
      images.push_back({(*corners)[raw(t[0])], (*corners)[raw(t[1])], (*corners)[raw(t[2])]});
    }
  }
  for (std::uint16_t vertex : child.parent_map) {
    if (vertex < reached.size())
      reached[vertex] = true;
  }
  return true;
}

std::vector<CornerTriangle> all_triangles(const PublishedTile& tile, const Tree& tree) {
  std::vector<CornerTriangle> triangles;
  for (const ShadedTriangle& t : border_of(tile, tree))
    triangles.push_back(t.corners);
  for (const TileTriangle& t : tile.mesh.interior) {
    triangles.push_back({make_corner(tile.node.index, raw(t[0])),
                         make_corner(tile.node.index, raw(t[1])),
                         make_corner(tile.node.index, raw(t[2]))});
  }
  normalize(triangles, true);
  return triangles;
}

std::size_t count_missing(const std::vector<CornerTriangle>& from,
                          const std::vector<CornerTriangle>& in) {
  std::vector<CornerTriangle> missing;
  std::set_difference(from.begin(), from.end(), in.begin(), in.end(), std::back_inserter(missing));
  return missing.size();
}

}  // namespace

void verify_image(const VerifyJob& job, const PublishedTile& tile) {
  const Tree& tree = job.tree();
  std::vector<CornerTriangle> images;
  std::vector<bool> reached(tile.mesh.own_count);
  const ChildTiles children = children_of(job, tile.node);
  for (const auto& child : children) {
    const auto& sibling = child == children.front() ? children.back() : children.front();
    if (!child || !sibling || !add_image(tree, *child, *sibling, tile.node, images, reached))
      return;
  }
  normalize(images, true);
  const auto triangles = all_triangles(tile, tree);
  const std::size_t lacking = count_missing(images, triangles);
  const std::size_t excess = count_missing(triangles, images);
  if (lacking + excess > 0) {
    job.problems.add(fmt::format(
        "tile {}: not the image of its children: {} triangles are missing, {} are not theirs",
        to_text(tile.node), lacking, excess));
  }
  const auto unreached = std::count(reached.begin(), reached.end(), false);
  if (unreached > 0) {
    job.problems.add(fmt::format("tile {}: {} of its vertices stand for no vertex of its children",
                                 to_text(tile.node), unreached));
  }
}

}  // namespace meshhier::verifying
