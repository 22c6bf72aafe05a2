#include "export/cut_mesh.h"

#include "base/error.h"
#include "hierarchy/drawing_rule.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

/// A border triangle as its tile sees it in the cut.
struct BorderView {
  CutTriangle corners{};
  bool drawn = true;
  bool original = true;  ///< all corners are vertices of partitions
};

BorderView view_border(const TileMesh& mesh, NodeId node, std::uint32_t base,
                       const TileTriangle& triangle,
                       const std::vector<std::optional<ShownGhost>>& ghosts, Level last) {
  BorderView view;
  view.original = node.level == last;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const TileVertex v = triangle[corner];
    if (mesh.is_own(v)) {
      view.corners[corner] = base + raw(v);
      continue;
    }
    const auto& ghost = ghosts[raw(v) - mesh.own_count];
    const bool ours = ghost && draws_before(node, mesh.ghost(v).tile, ghost->level);
    if (!ours)
      return {.corners = {}, .drawn = false, .original = false};
    view.corners[corner] = ghost->number;
    view.original = view.original && ghost->level == last;
  }
  return view;
}

/// A border triangle that is not the input's, where the cut shows it.
struct DrawnImage {
  CutTriangle corners;
  std::uint32_t border = 0;  ///< index among the tile's border triangles
  friend auto operator<=>(const DrawnImage&, const DrawnImage&) = default;
};

void add_each_once(std::vector<DrawnImage> images, DrawnTile& drawn) {
  std::sort(images.begin(), images.end());
  const auto end = std::unique(images.begin(), images.end(),
                               [](const auto& a, const auto& b) { return a.corners == b.corners; });
  std::for_each(images.begin(), end, [&](const DrawnImage& image) {
    drawn.triangles.push_back(image.corners);
    drawn.border.push_back(image.border);
  });
}

}  // namespace

std::size_t NumberedCut::position_of_vertex(std::uint32_t number) const {
  const auto after = std::upper_bound(bases.begin(), bases.end(), std::uint64_t{number});
  return static_cast<std::size_t>(after - bases.begin()) - 1;
}

NumberedCut number_vertices(const storage::HierarchyReader& reader, Cut cut) {
  std::vector<std::uint64_t> bases{0};
  for (NodeId node : cut.nodes())
    bases.push_back(bases.back() + reader.record(node).own_count);
  if (bases.back() > UINT32_MAX) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: the index gives a cut {} vertices, expected fewer than 2^32",
                            reader.directory().string(), bases.back()));
  }
  return {std::move(cut), std::move(bases)};
}

std::optional<ShownGhost> find_ghost(const Tree& tree, const NumberedCut& numbered,
                                     const PublishedTile& tile, std::size_t ghost) {
  const NodeId neighbour{tile.node.level, tile.mesh.ghosts[ghost].tile};
  const std::size_t position =
      numbered.cut.position_of(static_cast<PartitionId>(tree.partitions(neighbour).begin));
  const Level level = numbered.cut[position].level;
  if (level > tile.node.level)
    return std::nullopt;
  // The chain has the ghost's vertex in its own tile first, then in each tile above: one step a
  // level that the cut is coarser there.
  const GhostChain chain = tile.chains[ghost];
  const std::size_t step = raw(tile.node.level) - raw(level);
  const std::uint64_t count = numbered.bases[position + 1] - numbered.bases[position];
  if (step >= chain.size() || chain[step] >= count) {
    throw Error(ErrorCode::corrupt,
                fmt::format("tile {}: ghost {} has no vertex in tile {}: its chain is wrong",
                            to_text(tile.node), ghost, to_text(numbered.cut[position])));
  }
  return ShownGhost{position, level, numbered.base(position) + chain[step]};
}

DrawnTile draw_tile(const Tree& tree, const NumberedCut& numbered, std::size_t position,
                    const PublishedTile& tile) {
  const TileMesh& mesh = tile.mesh;
  const std::uint32_t base = numbered.base(position);
  std::vector<std::optional<ShownGhost>> ghosts(mesh.ghosts.size());
  for (std::size_t i = 0; i < ghosts.size(); ++i)
    ghosts[i] = find_ghost(tree, numbered, tile, i);

  DrawnTile drawn;
  drawn.triangles.reserve(mesh.interior.size() + mesh.border.size());
  for (const TileTriangle& t : mesh.interior) {
    drawn.triangles.push_back({base + raw(t[0]), base + raw(t[1]), base + raw(t[2])});
  }
  std::vector<DrawnImage> images;
  for (std::size_t i = 0; i < mesh.border.size(); ++i) {
    const BorderView view =
        view_border(mesh, tile.node, base, mesh.border[i], ghosts, tree.depth());
    if (!view.drawn) {
      drawn.left_out.push_back(static_cast<std::uint32_t>(i));
    } else if (view.original) {
      drawn.triangles.push_back(view.corners);
      drawn.border.push_back(static_cast<std::uint32_t>(i));
    } else if (!is_degenerate(view.corners)) {
      images.push_back({canonical(view.corners), static_cast<std::uint32_t>(i)});
    }
  }
  add_each_once(std::move(images), drawn);
  return drawn;
}

}  // namespace meshhier::exporting
