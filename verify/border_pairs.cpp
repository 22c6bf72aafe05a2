#include "verify/border_pairs.h"

#include "export/vertex_hash.h"
#include "hierarchy/cut.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

namespace meshhier::verifying {
namespace {

/// Hashes the corners, and their normals if `with_normals`.
std::uint64_t hash_of(const ShadedTriangle& triangle, bool with_normals) {
  const ShadedTriangle known{triangle.corners,
                             with_normals ? triangle.normals : Triangle<std::uint64_t>{}};
  return storage::checksum(std::as_bytes(std::span(&known, 1)));
}

/// Calls visit(tile) for each other tile that a triangle of `own` touches, once.
template <class Visit>
void for_each_other(const CornerTriangle& triangle, std::uint32_t own, Visit visit) {
  std::uint32_t met = own;
  for (const CornerId corner : triangle) {
    const std::uint32_t tile = tile_index(corner);
    if (tile == own || tile == met)
      continue;
    visit(tile);
    met = tile;
  }
}

}  // namespace

/// A node with the parent maps above it.
class BorderPairs::Node {
 public:
  Node(const Tree& tree, ParentMaps& maps, const PublishedTile& tile, NodeId node)
      : tree_(tree), tile_(tile), node_(node) {
    for (int level = raw(node.level); level > 1; --level) {
      const NodeId below = tree.ancestor(node, static_cast<Level>(level));
      maps_.push_back(tree.stands_for_parent(below) ? nullptr : maps.get(tree.tile_node(below)));
    }
  }

  NodeId id() const { return node_; }
  const PublishedTile& tile() const { return tile_; }

  /// The chain that a ghost of an own vertex has in `other`.
  void find_chain(std::uint32_t vertex, NodeId other, std::vector<std::uint16_t>& chain) const {
    const auto length = static_cast<std::size_t>(tree_.chain_length(node_, other));
    chain.assign(1, static_cast<std::uint16_t>(vertex));
    for (std::size_t step = 0; step + 1 < length; ++step) {
      // A tile that stands for its parent too: the entry is repeated, and its map leads past it.
      if (const auto& map = maps_[step]; map != nullptr)
        vertex = vertex < map->size() ? (*map)[vertex] : UINT16_MAX;
      chain.push_back(static_cast<std::uint16_t>(vertex));
    }
  }

 private:
  const Tree& tree_;
  const PublishedTile& tile_;
  NodeId node_;
  /// [k]: from the node k levels up to the next; null if its tile stands for that too.
  std::vector<std::shared_ptr<const std::vector<std::uint16_t>>> maps_;
};

void BorderPairs::add(const PublishedTile& tile) {
  add_sides(Node(tree_, maps_, tile, tile.node), border_of(tile, tree_), &tile);
  if (tree_.stands_for_parent(tile.node)) {
    add_sides(Node(tree_, maps_, tile, tree_.parent(tile.node)), early_border_of(tile, tree_),
              nullptr);
  }
}

void BorderPairs::add_sides(const Node& node, std::span<const ShadedTriangle> border,
                            const PublishedTile* ghosts_of) {
  SumsByOther sums;
  std::vector<Use> uses = add_triangles(node.id(), border, sums);
  add_own(node, std::move(uses), sums);
  if (ghosts_of != nullptr)
    add_ghosts(*ghosts_of, sums);
  const std::uint32_t own = node.id().index;
  for (const auto& [other, sum] : sums) {
    const NodePair pair{raw(node.id().level), std::min(own, other), std::max(own, other)};
    const bool by_high = own > other;
    sides_.add(PairSide{pair, by_high ? 1U : 0U, sum.triangles, by_high ? sum.other : sum.own,
                        by_high ? sum.own : sum.other});
  }
}

/// Returns which own vertices are in triangles that touch which others, with repeats.
std::vector<BorderPairs::Use> BorderPairs::add_triangles(NodeId node,
                                                         std::span<const ShadedTriangle> border,
                                                         SumsByOther& sums) const {
  std::vector<Use> uses;
  for (const ShadedTriangle& triangle : border) {
    for_each_other(triangle.corners, node.index, [&](std::uint32_t other) {
      sums[other].triangles += hash_of(triangle, compare_attributes(node, {node.level, other}));
      for (const CornerId corner : triangle.corners) {
        if (tile_index(corner) == node.index)
          uses.push_back({other, vertex_index(corner)});
      }
    });
  }
  return uses;
}

void BorderPairs::add_own(const Node& node, std::vector<Use> uses, SumsByOther& sums) const {
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  exporting::VertexHash hash;
  std::vector<std::uint16_t> chain;
  for (const Use& use : uses) {
    const NodeId other{node.id().level, use.other};
    node.find_chain(use.vertex, other, chain);
    const PublishedTile& tile = node.tile();
    sums[use.other].own +=
        hash(chain, {tile.mesh.vertices, use.vertex}, common_normal(tile, use.vertex, other),
             compare_attributes(node.id(), other));
  }
}

void BorderPairs::add_ghosts(const PublishedTile& tile, SumsByOther& sums) const {
  const TileMesh& mesh = tile.mesh;
  exporting::VertexHash hash;
  for (std::size_t i = 0; i < mesh.ghosts.size(); ++i) {
    const NodeId other{tile.node.level, mesh.ghosts[i].tile};
    const std::size_t vertex = mesh.own_count + i;
    sums[other.index].other +=
        hash(tile.chains[i], {mesh.vertices, vertex}, common_normal(tile, vertex, other),
             compare_attributes(tile.node, other));
  }
}

/// Returns none if one of both tiles has texture coordinates.
std::span<const NormalCode> BorderPairs::common_normal(const PublishedTile& tile,
                                                       std::size_t vertex, NodeId other) const {
  if (tree_.is_early(other) || has_texcoords_(other))
    return {};
  return exporting::normal_of(tile.shading, vertex);
}

/// A simplified tile may store attributes more coarsely than the partition beside it does, which
/// stands for an early node.
bool BorderPairs::compare_attributes(NodeId a, NodeId b) const {
  return !tree_.is_early(a) && !tree_.is_early(b);
}

bool BorderPairs::agree(const PairSide& low, const PairSide& high) const {
  // An early node has no ghosts of its own, so it makes no claims of its neighbours' vertices.
  const auto level = static_cast<Level>(low.pair.level);
  const bool low_knows = !tree_.is_early({level, low.pair.low});
  const bool high_knows = !tree_.is_early({level, low.pair.high});
  return low.triangles == high.triangles &&
         (!high_knows || low.low_vertices == high.low_vertices) &&
         (!low_knows || low.high_vertices == high.high_vertices);
}

void BorderPairs::finish(const std::function<void(const NodePair&)>& differ) {
  sides_.sort();
  PairSide low;
  bool waits = false;  // for the claims of `high` about the pair of `low`
  const auto give_up = [&] {
    if (waits)
      differ(low.pair);
    waits = false;
  };
  sides_.for_each_block([&](std::span<const PairSide> block) {
    for (const PairSide& side : block) {
      if (waits && side.pair == low.pair) {
        if (!agree(low, side))
          differ(side.pair);
        waits = false;
        continue;
      }
      give_up();
      if (side.by_high == 0) {
        low = side;
        waits = true;
      } else {
        differ(side.pair);
      }
    }
  });
  give_up();
}

}  // namespace meshhier::verifying
