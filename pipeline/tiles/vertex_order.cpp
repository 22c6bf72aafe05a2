#include "pipeline/tiles/vertex_order.h"

#include "storage/format/meshopt_codec.h"

#include <cassert>
#include <cstddef>
#include <numeric>
#include <span>

namespace meshhier::pipeline {
namespace {

constexpr std::uint32_t kNowhere = UINT32_MAX;

/// Returns the vertices of the tile in their new order: boundary and ghosts stay, inner ones come
/// as they are first used, unused ones last.
std::vector<std::uint32_t> new_order(const TileMesh& mesh) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.interior.size());
  for (const TileTriangle& t : mesh.interior)
    corners.insert(corners.end(), {raw(t[0]), raw(t[1]), raw(t[2])});
  std::vector<char> is_placed(mesh.own_count);
  std::vector<std::uint32_t> order(mesh.vertices.size() + 1);  // one more is written, and not kept
  std::size_t count = 0;
  const auto place = [&](std::uint32_t v) {  // which are new no processor can predict: no branch
    order[count] = v;
    count += std::size_t{is_placed[v] == 0};
    is_placed[v] = 1;
  };
  for (std::uint32_t v = 0; v < mesh.boundary_count; ++v)
    place(v);
  for (const std::uint32_t v : storage::vertex_cache_order(corners, mesh.vertices.size()))
    place(v);
  for (std::uint32_t v = 0; v < mesh.own_count; ++v)
    place(v);
  order.pop_back();
  std::iota(order.begin() + mesh.own_count, order.end(), mesh.own_count);
  return order;
}

}  // namespace

std::vector<std::uint32_t> order_inner_vertices(TileMesh& mesh,
                                                std::vector<std::uint16_t>& parent_map) {
  assert(parent_map.empty() || parent_map.size() == mesh.own_count);
  const std::vector<std::uint32_t> order = new_order(mesh);
  std::vector<std::uint32_t> place(order.size(), kNowhere);
  for (std::size_t i = 0; i < order.size(); ++i)
    place[order[i]] = static_cast<std::uint32_t>(i);

  VertexArray vertices;
  vertices.channels = mesh.vertices.channels;
  vertices.reserve(order.size());
  vertices.append(mesh.vertices, order);
  mesh.vertices = std::move(vertices);
  std::vector<std::uint16_t> parents(parent_map.size());
  for (std::size_t v = 0; v < parents.size(); ++v)
    parents[place[v]] = parent_map[v];
  parent_map = std::move(parents);
  for (TileTriangle& t : mesh.interior)
    t = {TileVertex{place[raw(t[0])]}, TileVertex{place[raw(t[1])]}, TileVertex{place[raw(t[2])]}};
  normalize_triangles(mesh.interior, mesh.interior_wedges, false);
  if (!mesh.copies.empty())
    mesh.copies = renumbered(mesh.copies, place);
  return place;
}

}  // namespace meshhier::pipeline
