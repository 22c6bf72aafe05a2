#include "bench/level_surface.h"

#include "hierarchy/cut.h"

#include <utility>

namespace meshhier::bench {
namespace {

/// Few neighbours are shown coarser: those of partitions below early nodes.
constexpr std::uint64_t kCacheBytes = std::uint64_t{16} << 20;

void move_place(TileMesh& mesh, std::uint32_t place, Vec3f position) {
  mesh.vertices.positions[place] = position;
  for (std::size_t i = mesh.copies.first_of(place);
       i < mesh.copies.size() && mesh.copies.places[i] == place; ++i)
    mesh.copies.vertices.positions[i] = position;
}

}  // namespace

LevelSurface::LevelSurface(const storage::HierarchyReader& reader, Level level)
    : reader_(reader),
      numbered_(inspection::number_vertices(reader, Cut::of_level(reader.tree(), level))),
      positions_(
          kCacheBytes,
          [&reader](NodeId node) { return reader.read_tile(node).mesh.vertices.positions; },
          [](const std::vector<Vec3f>& positions) { return positions.size() * sizeof(Vec3f); }) {}

ShownTile LevelSurface::load(std::size_t position) {
  PublishedTile tile = reader_.read_tile(numbered_.cut[position]);
  inspection::DrawnTile drawn = inspection::draw_tile(reader_.tree(), numbered_, position, tile);
  move_ghosts(tile);
  return {std::move(tile), std::move(drawn.border)};
}

void LevelSurface::move_ghosts(PublishedTile& tile) {
  for (std::size_t i = 0; i < tile.mesh.ghosts.size(); ++i) {
    const auto shown = inspection::find_ghost(reader_.tree(), numbered_, tile, i);
    if (!shown || shown->level == tile.node.level)
      continue;
    const auto positions = positions_.get(numbered_.cut[shown->position]);
    move_place(tile.mesh, tile.mesh.own_count + static_cast<std::uint32_t>(i),
               (*positions)[shown->number - numbered_.base(shown->position)]);
  }
}

}  // namespace meshhier::bench
