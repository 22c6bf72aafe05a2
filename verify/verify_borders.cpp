// Explains what is wrong between two neighbours that do not agree (border_pairs.h).
#include "export/tile_vertices.h"
#include "hierarchy/cut.h"
#include "verify/corner_triangle.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// Counts what is wrong with the ghosts in one neighbour, so that a broken pair of tiles is one
/// line.
class GhostTally {
 public:
  void require(bool holds, std::size_t ghost) {
    if (holds)
      return;
    if (count_++ == 0)
      first_ = ghost;
  }
  void report(const VerifyJob& job, NodeId tile, NodeId neighbour, std::string_view what) const {
    if (count_ == 0)
      return;
    job.problems.add(fmt::format("tile {}: of its ghosts in tile {}, {} {} (the first: ghost {})",
                                 to_text(tile), to_text(neighbour), count_, what, first_));
  }

 private:
  std::size_t count_ = 0, first_ = 0;
};

/// The ghosts [begin, end) of a tile are vertices of the node.
struct GhostGroup {
  NodeId node;
  std::size_t begin, end;
};

GhostGroup ghosts_in(const PublishedTile& tile, NodeId neighbour) {
  const auto& ghosts = tile.mesh.ghosts;
  const auto at = [&](std::uint32_t index) {
    const auto found = std::lower_bound(ghosts.begin(), ghosts.end(), GhostRef{index, 0});
    return static_cast<std::size_t>(found - ghosts.begin());
  };
  return {neighbour, at(neighbour.index), at(neighbour.index + 1)};
}

void check_ghosts(const VerifyJob& job, const PublishedTile& tile, const GhostGroup& group,
                  const PublishedTile& neighbour) {
  const Tree& tree = job.tree();
  const bool have_texcoords =
      !tile.shading.texcoords.empty() || !neighbour.shading.texcoords.empty();
  // A simplified tile may store attributes more coarsely than the partition beside it does.
  const bool same_kind = tree.is_partition(tile.node) == tree.is_partition(neighbour.node);
  GhostTally missing, moved, recoloured, shaded;
  for (std::size_t i = group.begin; i < group.end; ++i) {
    const std::size_t vertex = tile.mesh.ghosts[i].index;
    missing.require(vertex < neighbour.mesh.boundary_count, i);
    if (vertex >= neighbour.mesh.boundary_count)
      continue;
    const exporting::VertexAt own{neighbour.mesh.vertices, vertex};
    const exporting::VertexAt seen{tile.mesh.vertices, tile.mesh.own_count + i};
    moved.require(exporting::has_same_position(seen, own), i);
    if (!same_kind)
      continue;
    recoloured.require(exporting::has_same_attributes(seen, own), i);
    shaded.require(
        have_texcoords ||
            std::ranges::equal(exporting::normal_of(tile.shading, tile.mesh.own_count + i),
                               exporting::normal_of(neighbour.shading, vertex)),
        i);
  }
  missing.report(job, tile.node, neighbour.node, "are not vertices of its boundary");
  moved.report(job, tile.node, neighbour.node, "have not its position");
  recoloured.report(job, tile.node, neighbour.node, "have not its attributes");
  shaded.report(job, tile.node, neighbour.node, "have not its normal");
}

/// Entry k of a chain is entry k-1 through the parent map of the tile that k-1 is a vertex of. A
/// tile that stands for its parent too has the same entry twice, and its map leads past that.
void check_chains(const VerifyJob& job, const PublishedTile& tile, const GhostGroup& group) {
  const Tree& tree = job.tree();
  GhostTally wrong;
  std::vector<std::uint16_t> reached;
  for (std::size_t i = group.begin; i < group.end; ++i) {
    reached.push_back(static_cast<std::uint16_t>(tile.mesh.ghosts[i].index));
    wrong.require(tile.chains[i].front() == tile.mesh.ghosts[i].index, i);
  }
  const int length = tree.chain_length(tile.node, group.node);
  for (int step = 1; step < length; ++step) {
    const NodeId from =
        tree.ancestor(group.node, static_cast<Level>(raw(group.node.level) - step + 1));
    if (tree.stands_for_parent(from)) {
      for (std::size_t i = group.begin; i < group.end; ++i) {
        wrong.require(tile.chains[i][static_cast<std::size_t>(step)] == reached[i - group.begin],
                      i);
      }
      continue;
    }
    const auto below = job.tiles.find(from);
    if (!below)
      return;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      std::uint16_t& vertex = reached[i - group.begin];
      const bool known = vertex < below->parent_map.size();
      if (known)
        vertex = below->parent_map[vertex];
      wrong.require(known && tile.chains[i][static_cast<std::size_t>(step)] == vertex, i);
    }
  }
  wrong.report(job, tile.node, group.node, "have chains that are not its parent maps'");
}

std::vector<ShadedTriangle> border_triangles(const VerifyJob& job, const PublishedTile& tile,
                                             NodeId node) {
  return tile.node == node ? border_of(tile, job.tree()) : early_border_of(tile, job.tree());
}

/// Returns the triangles of `border` that touch another tile.
std::vector<ShadedTriangle> touching(const std::vector<ShadedTriangle>& border,
                                     std::uint32_t other) {
  std::vector<ShadedTriangle> met;
  std::copy_if(border.begin(), border.end(), std::back_inserter(met), [&](const auto& triangle) {
    return std::any_of(triangle.corners.begin(), triangle.corners.end(),
                       [&](CornerId corner) { return tile_index(corner) == other; });
  });
  return met;
}

/// Every triangle of `tile` that touches the neighbour is in the neighbour's list, as often, with
/// the same normals.
void check_lists(const VerifyJob& job, NodeId node, const PublishedTile& tile, NodeId other,
                 const PublishedTile& neighbour) {
  const auto here = touching(border_triangles(job, tile, node), other.index);
  const auto there = border_triangles(job, neighbour, other);
  const auto told = [&](const char* what) {
    job.problems.add(fmt::format("tile {}: some of its {} border triangles with tile {} {} there",
                                 to_text(node), here.size(), to_text(other), what));
  };
  const bool are_listed =
      std::ranges::includes(there, here, {}, &ShadedTriangle::corners, &ShadedTriangle::corners);
  if (!are_listed)
    told("are not listed");
  // An early node's triangles have no normals of their own.
  const bool have_normals = tile.node == node && neighbour.node == other;
  if (are_listed && have_normals && !std::ranges::includes(there, here))
    told("have other normals");
}

/// Checks the claims of the first of two neighbours about the second. The tiles stand for the
/// nodes.
void check_side(const VerifyJob& job, NodeId node, const PublishedTile& tile, NodeId other,
                const PublishedTile& neighbour) {
  if (tile.node == node) {
    const GhostGroup group = ghosts_in(tile, other);
    check_ghosts(job, tile, group, neighbour);
    check_chains(job, tile, group);
  }
  check_lists(job, node, tile, other, neighbour);
}

}  // namespace

bool compare_neighbours(const VerifyJob& job, NodeId a, NodeId b) {
  const auto tile = job.tiles.find(a), neighbour = job.tiles.find(b);
  if (!tile || !neighbour)
    return false;  // told already
  check_side(job, a, *tile, b, *neighbour);
  check_side(job, b, *neighbour, a, *tile);
  return true;
}

void explain_difference(const VerifyJob& job, NodeId a, NodeId b) {
  const std::uint64_t told = job.problems.count();
  if (told < ProblemList::kLimit && !compare_neighbours(job, a, b))
    return;
  if (job.problems.count() == told) {
    job.problems.add(fmt::format("tiles {} and {}: say different things of the border between them",
                                 to_text(a), to_text(b)));
  }
}

void tell_wrong_copies(const VerifyJob& job, const WrongCopies& wrong) {
  const storage::TileFormat& format = job.reader.tile_format();
  const bool has_common_splits = format.computed_normals && !format.textures && !format.normal_maps;
  job.problems.add(fmt::format(
      "tile {}: of its {} of vertices in tile {}, {} are not there, or in another order (the "
      "first: of vertex {})",
      to_text(wrong.tile), has_common_splits ? "copies and splits" : "copies",
      to_text(wrong.neighbour), wrong.count, wrong.first_place));
}

}  // namespace meshhier::verifying
