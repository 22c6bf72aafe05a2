#include "bench/cell_mesh.h"

#include "hierarchy/error.h"

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

Vec3f representative_of(const BuildTile& cell, const cluster_simplify::ContractionOptions& how) {
  if (cell.mesh.own_count > kMostCellVertices) {
    throw Error(ErrorCode::usage,
                fmt::format("a cell has {} vertices, at most {} become one: ask for more cells",
                            cell.mesh.own_count, kMostCellVertices));
  }
  return cluster_simplify::contract(cell, 1, {}, how).representatives.positions[0];
}

}  // namespace

PlainMesh cell_mesh(const PlainMesh& mesh, const Parts& cells,
                    cluster_simplify::Representative representative) {
  const cluster_simplify::ContractionOptions how{.method = cluster_simplify::Method::cluster,
                                                 .representative = representative};
  PlainMesh result;
  const PartTiles tiles(mesh, cells);
  for (std::uint32_t cell = 0; cell < cells.count; ++cell)
    result.positions.push_back(representative_of(tiles.tile(cell), how));

  std::vector<TileTriangle> images;
  for (const MeshTriangle& t : mesh.triangles) {
    TileTriangle image{};
    for (std::size_t k = 0; k < 3; ++k)
      image[k] = static_cast<TileVertex>(cells.part_of[t[k]]);
    if (!is_degenerate(image))
      images.push_back(image);
  }
  normalize_triangles(images, true);
  for (const TileTriangle& t : images)
    result.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
  return result;
}

}  // namespace meshhier::bench
