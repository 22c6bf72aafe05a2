// The proof that every cut is seamless, one tile at a time.
//
// All levels show images of the original mesh under maps of vertices, and the maps of neighbours
// agree (verify_borders). So if the triangles of each simplified tile are the images of its
// children's, then by induction the triangles of every tile are the images of the original ones
// that touch its node; and a cut, which draws each of them once, shows the image of the original
// mesh under one map of vertices. A closed surface stays closed under any such map.
#include "pipeline/corner_triangle.h"
#include "pipeline/cut.h"
#include "pipeline/verify_parts.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

/// The image of ghost i of `child`, or nothing if its chain is wrong (told by verify_borders).
std::optional<Corner> ghost_image(const VerifyJob& job, const PublishedTile& child, std::size_t i,
                                  NodeId parent) {
  const Tree& tree = job.tree();
  const NodeId neighbour{child.node.level, child.mesh.ghosts[i].tile};
  const std::size_t up = raw(child.node.level) - raw(parent.level);
  const GhostChain& chain = child.chains[i];
  const NodeId above = tree.ancestor(neighbour, parent.level);
  if (above != parent) {
    if (up >= chain.size())
      return std::nullopt;
    return make_corner(above.index, chain[up]);
  }
  // A vertex of the other child: the chain ends there, its parent map leads on.
  const auto sibling = job.tiles.find(tree.ancestor(neighbour, finer(parent.level)));
  if (!sibling || up - 1 >= chain.size())
    return std::nullopt;
  const std::uint16_t vertex = chain[up - 1];
  if (vertex >= sibling->parent_map.size())
    return std::nullopt;
  return make_corner(parent.index, sibling->parent_map[vertex]);
}

/// The vertices of a child's tile as vertices of the parent's level; nothing if the child is
/// broken.
std::optional<std::vector<Corner>> image_of_vertices(const VerifyJob& job,
                                                     const PublishedTile& child, NodeId parent) {
  std::vector<Corner> images;
  images.reserve(child.mesh.vertices.size());
  if (child.parent_map.size() != child.mesh.own_count)
    return std::nullopt;
  for (std::uint16_t vertex : child.parent_map)
    images.push_back(make_corner(parent.index, vertex));
  for (std::size_t i = 0; i < child.mesh.ghosts.size(); ++i) {
    const auto image = ghost_image(job, child, i, parent);
    if (!image)
      return std::nullopt;
    images.push_back(*image);
  }
  return images;
}

/// Adds the images of a child's triangles. False if the child is broken, which is told elsewhere.
bool add_image(const VerifyJob& job, NodeId child, NodeId parent,
               std::vector<CornerTriangle>& images, std::vector<bool>& reached) {
  const auto tile = job.tiles.find(child);
  if (!tile)
    return false;
  const auto corners = image_of_vertices(job, *tile, parent);
  if (!corners)
    return false;
  for (const auto* list : {&tile->mesh.interior, &tile->mesh.border}) {
    for (const Triangle& t : *list) {
      images.push_back({(*corners)[raw(t[0])], (*corners)[raw(t[1])], (*corners)[raw(t[2])]});
    }
  }
  for (std::uint16_t vertex : tile->parent_map) {
    if (vertex < reached.size())
      reached[vertex] = true;
  }
  return true;
}

std::vector<CornerTriangle> all_triangles(const PublishedTile& tile, const Tree& tree) {
  std::vector<CornerTriangle> triangles = border_of(tile, tree);
  for (const Triangle& t : tile.mesh.interior) {
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
  const Tree::Children children = tree.children(tile.node);
  for (NodeId child : children.span()) {
    if (!add_image(job, child, tile.node, images, reached))
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

}  // namespace meshhier::pipeline
