#include "hierarchy/object_parts.h"

#include "hierarchy/drawing_rule.h"
#include "hierarchy/value_channels.h"
#include "hierarchy/vertex_numbers.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>

namespace meshhier {
namespace {

/// The vertices of a tile by their numbers, copies behind the others.
class NumberedVertices {
 public:
  NumberedVertices(const TileMesh& mesh, const AttributeLayout& layout)
      : mesh_(mesh), object_(placed_object(layout).value()) {}

  Vec3f position(TileVertex vertex) const {
    const auto [vertices, number] = found(vertex);
    return vertices.positions[number];
  }
  std::uint32_t object(TileVertex vertex) const {
    const auto [vertices, number] = found(vertex);
    return static_cast<std::uint32_t>(object_.in(vertices.attributes_of(number).data()));
  }
  std::vector<TileTriangle> interior() const {
    return numbers_.numbered(mesh_.interior, mesh_.interior_wedges);
  }
  std::vector<TileTriangle> border() const {
    return numbers_.numbered(mesh_.border, mesh_.border_wedges);
  }

 private:
  struct Found {
    const VertexArray& vertices;
    std::size_t number;
  };
  Found found(TileVertex vertex) const {
    const std::size_t places = mesh_.vertices.size();
    const std::size_t number = raw(vertex);
    return number < places ? Found{mesh_.vertices, number}
                           : Found{mesh_.copies.vertices, number - places};
  }

  const TileMesh& mesh_;
  PlacedValue object_;
  VertexNumbers numbers_{static_cast<std::uint32_t>(mesh_.vertices.size()), mesh_.copies.places};
};

/// The coarsest level whose cut shows a tile: a partition stands for early nodes above it.
std::uint32_t first_level(const Tree& tree, NodeId node) {
  NodeId top = node;
  while (raw(top.level) > 0 && tree.is_early(tree.parent(top)))
    top = tree.parent(top);
  return static_cast<std::uint32_t>(raw(tree.is_partition(node) ? top.level : node.level));
}

using PartsByObject = std::map<std::uint32_t, ObjectPart>;

void add(const TileTriangle& triangle, const NumberedVertices& vertices, Vec3d origin,
         PartsByObject& parts) {
  ObjectPart& part = parts[vertices.object(triangle[0])];
  std::array<Vec3d, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = to_double(vertices.position(triangle[k])) + origin;
    part.box.add(corners[k]);
  }
  part.area += length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
  ++part.triangles;
}

}  // namespace

std::vector<ObjectPart> object_parts(const Tree& tree, NodeId node, const TileMesh& mesh,
                                     const AttributeLayout& layout, Vec3d origin) {
  const NumberedVertices vertices(mesh, layout);
  PartsByObject parts;
  for (const TileTriangle& triangle : vertices.interior())
    add(triangle, vertices, origin, parts);
  const std::vector<TileTriangle> border = vertices.border();
  const auto goes_before = [&](std::size_t ghost) {
    return draws_before(tree, node, mesh.ghosts[ghost].tile);
  };
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (draws(mesh, mesh.border[i], goes_before))
      add(border[i], vertices, origin, parts);
  }
  std::vector<ObjectPart> all;
  for (auto& [object, part] : parts) {
    part.object = object;
    part.level = static_cast<std::uint32_t>(raw(node.level));
    part.first_level = first_level(tree, node);
    all.push_back(part);
  }
  return all;
}

std::optional<TileTriangle> torn_triangle(const TileMesh& mesh, const AttributeLayout& layout) {
  const NumberedVertices vertices(mesh, layout);
  const auto is_torn = [&](const TileTriangle& triangle) {
    return vertices.object(triangle[0]) != vertices.object(triangle[1]) ||
           vertices.object(triangle[0]) != vertices.object(triangle[2]);
  };
  for (const auto& triangles : {vertices.interior(), vertices.border()}) {
    const auto torn = std::ranges::find_if(triangles, is_torn);
    if (torn != triangles.end())
      return *torn;
  }
  return std::nullopt;
}

}  // namespace meshhier
