#include "pipeline/tiles/tile_normals.h"

#include "hierarchy/normal_code.h"
#include "hierarchy/vertex_numbers.h"
#include "pipeline/tiles/vertex_order.h"
#include "shading/tile_shading.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

namespace meshhier::pipeline {
namespace {

Shading shading_with(const Forest& forest, NodeId node, const TileMesh& mesh,
                     const OwnShading& own) {
  return shading::shade_tile(mesh, own, [&](std::uint32_t tile) {
    return forest.boundary_normals({node.level, tile});
  });
}

/// Returns the normals of all vertices and splits: those that were computed, or else the input's.
std::vector<Vec3f> vertex_normals(const TileMesh& mesh, const AttributeLayout& layout,
                                  const Shading& shading) {
  std::vector<Vec3f> normals;
  normals.reserve(std::max(shading.normals.size(), mesh.vertices.size() + mesh.copies.size()));
  for (const NormalCode& code : shading.normals)
    normals.push_back(normal_of(code));
  if (!normals.empty())
    return normals;
  const AttributePart& part = layout.part(AttributeKind::normals);
  for (const VertexArray* vertices : {&mesh.vertices, &mesh.copies.vertices}) {
    for (std::size_t i = 0; i < vertices->size(); ++i) {
      const auto given = part.of(vertices->attributes_of(i));
      const Vec3f normal{given[0], given[1], given[2]};
      normals.push_back(is_finite(normal) ? normal : Vec3f{});
    }
  }
  return normals;
}

}  // namespace

Shading computed_shading(const Forest& forest, NodeId node, const TileMesh& mesh) {
  return forest.computes_normals() ? shading_with(forest, node, mesh, forest.normals(node))
                                   : Shading{};
}

OrderedTile ordered_tile(const Forest& forest, NodeId node, TileMesh mesh) {
  OrderedTile tile{std::move(mesh), forest.published_parent_map(node), {}};
  if (!forest.tree().is_partition(node)) {
    tile.shading = computed_shading(forest, node, tile.mesh);
    return tile;
  }
  const std::vector<std::uint32_t> copy_places = tile.mesh.copies.places;
  const std::vector<std::uint32_t> place = order_inner_vertices(tile.mesh, tile.parent_map);
  if (forest.computes_normals()) {
    const OwnShading own =
        shading::renumbered(forest.normals(node), copy_places, place, tile.mesh.own_count);
    tile.shading = shading_with(forest, node, tile.mesh, own);
  }
  return tile;
}

std::vector<texture::CornerNormals> corner_normals(const TileMesh& mesh,
                                                   const AttributeLayout& layout,
                                                   const Shading& shading) {
  const std::vector<Vec3f> normals = vertex_normals(mesh, layout, shading);
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  std::vector<texture::CornerNormals> corners;
  corners.reserve(mesh.interior.size() + mesh.border.size());
  const auto add = [&](std::span<const TileTriangle> triangles) {
    for (const auto& [a, b, c] : triangles)
      corners.push_back({normals[raw(a)], normals[raw(b)], normals[raw(c)]});
  };
  const bool split = !shading.split_of.empty();
  add(split ? shading.interior : numbers.numbered(mesh.interior, mesh.interior_wedges));
  add(split ? shading.border : numbers.numbered(mesh.border, mesh.border_wedges));
  return corners;
}

}  // namespace meshhier::pipeline
