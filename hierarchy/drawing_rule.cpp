#include "hierarchy/drawing_rule.h"

#include <vector>

namespace meshhier {

std::uint32_t drawn_border_count(const Tree& tree, NodeId tile, const TileMesh& mesh) {
  std::vector<bool> before;
  before.reserve(mesh.ghosts.size());
  for (const GhostRef& ghost : mesh.ghosts)
    before.push_back(draws_before(tree, tile, ghost.tile));
  return static_cast<std::uint32_t>(
      std::count_if(mesh.border.begin(), mesh.border.end(), [&](const TileTriangle& t) {
        return draws(mesh, t, [&](std::size_t ghost) { return before[ghost]; });
      }));
}

}  // namespace meshhier
