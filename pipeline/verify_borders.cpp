#include "pipeline/cut.h"
#include "pipeline/verify_parts.h"

#include <algorithm>
#include <compare>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace meshhier::pipeline {
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

/// The ghosts [begin, end) of `tile` are vertices of `neighbour`, whose node is `node`.
struct GhostGroup {
  NodeId node;
  std::size_t begin, end;
};

std::vector<GhostGroup> group_ghosts(const PublishedTile& tile) {
  std::vector<GhostGroup> groups;
  const auto& ghosts = tile.mesh.ghosts;
  for (std::size_t i = 0; i < ghosts.size(); ++i) {
    if (i == 0 || ghosts[i].tile != ghosts[i - 1].tile) {
      groups.push_back({{tile.node.level, ghosts[i].tile}, i, i});
    }
    groups.back().end = i + 1;
  }
  return groups;
}

bool same_attributes(const VertexArray& a, std::size_t i, const VertexArray& b, std::size_t j) {
  const auto x = a.attributes_of(i), y = b.attributes_of(j);
  return x.empty() || std::memcmp(x.data(), y.data(), x.size_bytes()) == 0;
}

/// Bits, not values: -0 is not 0 where "bit for bit" is promised.
bool same_position(const VertexArray& a, std::size_t i, const VertexArray& b, std::size_t j) {
  return std::memcmp(&a.positions[i], &b.positions[j], sizeof(Vec3f)) == 0;
}

void check_ghosts(const VerifyJob& job, const PublishedTile& tile, const GhostGroup& group,
                  const PublishedTile& neighbour) {
  const Tree& tree = job.tree();
  // A simplified tile may store attributes more coarsely than the partition beside it does.
  const bool same_kind = tree.is_partition(tile.node) == tree.is_partition(neighbour.node);
  GhostTally missing, moved, recoloured;
  for (std::size_t i = group.begin; i < group.end; ++i) {
    const std::size_t vertex = tile.mesh.ghosts[i].index;
    missing.require(vertex < neighbour.mesh.rim_count, i);
    if (vertex >= neighbour.mesh.rim_count)
      continue;
    const std::size_t here = tile.mesh.own_count + i;
    const VertexArray &own = neighbour.mesh.vertices, &seen = tile.mesh.vertices;
    moved.require(same_position(seen, here, own, vertex), i);
    if (same_kind)
      recoloured.require(same_attributes(seen, here, own, vertex), i);
  }
  missing.report(job, tile.node, neighbour.node, "are not vertices of its rim");
  moved.report(job, tile.node, neighbour.node, "have not its position");
  recoloured.report(job, tile.node, neighbour.node, "have not its attributes");
}

/// Entry k of a chain is entry k-1 through the parent map of the tile that k-1 is a vertex of. An
/// early node has no tile: its entry repeats the one below, and the partition's map leads past it.
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
    const int level = raw(group.node.level) - step;
    if (tree.is_early(tree.ancestor(group.node, static_cast<Level>(level)))) {
      for (std::size_t i = group.begin; i < group.end; ++i) {
        wrong.require(tile.chains[i][static_cast<std::size_t>(step)] == reached[i - group.begin],
                      i);
      }
      continue;
    }
    const auto below = job.tiles.find(tree.ancestor(group.node, static_cast<Level>(level + 1)));
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

/// A border triangle, once for each other tile that it touches.
struct SharedTriangle {
  std::uint32_t neighbour;
  CornerTriangle triangle;
  friend auto operator<=>(const SharedTriangle&, const SharedTriangle&) = default;
};

std::vector<SharedTriangle> shared_triangles(NodeId node,
                                             const std::vector<CornerTriangle>& border) {
  std::vector<SharedTriangle> shared;
  for (const CornerTriangle& t : border) {
    for (std::size_t k = 0; k < t.size(); ++k) {
      const std::uint32_t tile = tile_index(t[k]);
      const bool is_met = std::any_of(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(k),
                                      [&](Corner c) { return tile_index(c) == tile; });
      if (tile != node.index && !is_met)
        shared.push_back({tile, t});
    }
  }
  std::sort(shared.begin(), shared.end());
  return shared;
}

/// Whether all of one neighbour's shared triangles are among `theirs`, as often as here.
bool are_listed(std::span<const SharedTriangle> shared, const std::vector<CornerTriangle>& theirs) {
  for (std::size_t begin = 0, end = 0; begin < shared.size(); begin = end) {
    while (end < shared.size() && shared[end] == shared[begin])
      ++end;
    const auto [low, high] = std::equal_range(theirs.begin(), theirs.end(), shared[begin].triangle);
    if (static_cast<std::size_t>(high - low) < end - begin)
      return false;
  }
  return true;
}

/// Every triangle of `border` (of `node`) is in the list of each other tile it touches.
void check_lists(const VerifyJob& job, BorderLists& lists, NodeId node,
                 const std::vector<CornerTriangle>& border) {
  const std::vector<SharedTriangle> all = shared_triangles(node, border);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].neighbour == all[begin].neighbour)
      ++end;
    const NodeId neighbour{node.level, all[begin].neighbour};
    if (!job.tiles.find(neighbour))
      continue;
    if (are_listed(std::span(all).subspan(begin, end - begin), *lists.get(neighbour)))
      continue;
    job.problems.add(
        fmt::format("tile {}: some of its {} border triangles with tile {} are not listed there",
                    to_text(node), end - begin, to_text(neighbour)));
  }
}

}  // namespace

BorderLists make_border_lists(const VerifyJob& job) {
  return {job.options.memory_budget / 16,
          [&job](NodeId node) {
            const auto tile = job.tiles.find(node);
            if (!tile)
              return std::vector<CornerTriangle>{};
            return tile->node.level == node.level ? border_of(*tile, job.tree())
                                                  : early_border_of(*tile, job.tree());
          },
          [](const auto& list) { return list.size() * sizeof(list[0]) + sizeof(list); }};
}

void verify_borders(const VerifyJob& job, BorderLists& lists, const PublishedTile& tile) {
  const Tree& tree = job.tree();
  for (const GhostGroup& group : group_ghosts(tile)) {
    if (group.node == tile.node) {
      job.problems.add(fmt::format("tile {}: has itself as a neighbour", to_text(tile.node)));
      return;
    }
    if (const auto neighbour = job.tiles.find(group.node)) {
      check_ghosts(job, tile, group, *neighbour);
    }
    check_chains(job, tile, group);
  }
  check_lists(job, lists, tile.node, *lists.get(tile.node));
  if (tile.node.level == Level{})
    return;
  const NodeId above = tree.parent(tile.node);
  if (tree.is_early(above))
    check_lists(job, lists, above, *lists.get(above));
}

}  // namespace meshhier::pipeline
