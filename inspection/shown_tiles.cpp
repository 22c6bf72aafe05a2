#include "inspection/shown_tiles.h"

#include <utility>

namespace meshhier::inspection {
namespace {

void move_place(TileMesh& mesh, std::uint32_t place, Vec3f position) {
  mesh.vertices.positions[place] = position;
  for (std::size_t i = mesh.copies.first_of(place);
       i < mesh.copies.size() && mesh.copies.places[i] == place; ++i)
    mesh.copies.vertices.positions[i] = position;
}

}  // namespace

ShownTiles::ShownTiles(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes)
    : reader_(reader),
      numbered_(exporting::number_vertices(reader, std::move(cut))),
      positions_(
          cache_bytes,
          [&reader](NodeId node) { return reader.read_tile(node).mesh.vertices.positions; },
          [](const std::vector<Vec3f>& positions) { return positions.size() * sizeof(Vec3f); }) {}

void ShownTiles::will_load(std::span<const std::size_t> positions) const {
  std::vector<NodeId> nodes;
  for (const std::size_t position : positions)
    nodes.push_back(numbered_.cut[position]);
  reader_.will_read(nodes);
}

ShownTile ShownTiles::load(std::size_t position) {
  PublishedTile tile = reader_.read_tile(numbered_.cut[position]);
  exporting::DrawnTile drawn = draw_tile(reader_.tree(), numbered_, position, tile);
  move_ghosts(tile);
  return {std::move(tile), std::move(drawn.border)};
}

void ShownTiles::move_ghosts(PublishedTile& tile) {
  for (std::size_t i = 0; i < tile.mesh.ghosts.size(); ++i) {
    const auto shown = find_ghost(reader_.tree(), numbered_, tile, i);
    if (!shown || shown->level == tile.node.level)
      continue;
    const auto positions = positions_.get(numbered_.cut[shown->position]);
    move_place(tile.mesh, tile.mesh.own_count + static_cast<std::uint32_t>(i),
               (*positions)[shown->number - numbered_.base(shown->position)]);
  }
}

}  // namespace meshhier::inspection
