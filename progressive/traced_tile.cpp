#include "progressive/traced_tile.h"

#include "base/error.h"
#include "hierarchy/drawing_rule.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

namespace meshhier::progressive {
namespace {

[[noreturn]] void fail(NodeId node, const std::string& what) {
  throw Error(ErrorCode::corrupt, "tile " + std::to_string(raw(node.level)) + "/" +
                                      std::to_string(node.index) + ": " + what);
}

bool same_bits(Vec3f a, std::span<const float> b) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return bits(a.x) == bits(b[0]) && bits(a.y) == bits(b[1]) && bits(a.z) == bits(b[2]);
}

TileVertex vertex_of(std::size_t number) {
  return static_cast<TileVertex>(number);
}

VertexValues values_of(const VertexArray& vertices, std::size_t count) {
  VertexValues values;
  values.width = 3 + static_cast<std::size_t>(vertices.channels);
  values.values.reserve(count * values.width);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p = vertices.positions[i];
    values.append(std::array{p.x, p.y, p.z});
    values.append(vertices.attributes_of(i));
  }
  return values;
}

/// A child's ghost, one level up.
struct RaisedGhost {
  GhostRef ref;
  std::size_t child = 0;
  std::size_t ghost = 0;
};

/// Maps the vertices of up to two children to the parent's.
class Raiser {
 public:
  Raiser(const Tree& tree, NodeId parent, std::vector<TracedTile> children, bool keep)
      : tree_(tree), parent_(parent), children_(std::move(children)), keep_(keep) {}

  std::vector<TracedTile>& children() { return children_; }

  /// Requires maps within own_count, which is the parent's.
  void raise(std::size_t own_count, TracedTile& to) {
    own_count_ = own_count;
    collect_ghosts();
    for (const RaisedGhost& ghost : ghosts_) {
      to.ghosts.push_back(ghost.ref);
      to.chains.add(children_[ghost.child].chains[ghost.ghost].subspan(1));
    }
    for (std::size_t child = 0; child < children_.size(); ++child)
      map_vertices(child, to.ghosts);
  }

  /// Returns the image of a triangle of a child.
  TileTriangle image_of(std::size_t child, const TileTriangle& t) const {
    return {maps_[child][raw(t[0])], maps_[child][raw(t[1])], maps_[child][raw(t[2])]};
  }

  std::uint16_t own_image(std::size_t child, std::size_t vertex) const {
    return keep_ ? static_cast<std::uint16_t>(vertex) : children_[child].parent_map[vertex];
  }

 private:
  GhostRef raised(const TracedTile& child, std::size_t ghost) const {
    const GhostChain chain = child.chains[ghost];
    const NodeId neighbour{child.node.level, child.ghosts[ghost].tile};
    const std::uint32_t tile = tree_.parent(neighbour).index;
    // The sibling's vertices become the parent's own.
    if (tile == parent_.index)
      return {tile, own_image_in(neighbour, chain[0])};
    if (chain.size() < 2)
      fail(child.node, "ghost " + std::to_string(ghost) + " has no vertex one level up");
    return {tile, chain[1]};
  }

  /// Returns the image of a vertex of the child's sibling.
  std::uint32_t own_image_in(NodeId sibling, std::uint32_t vertex) const {
    for (std::size_t i = 0; i < children_.size(); ++i) {
      if (children_[i].node == sibling && vertex < children_[i].ranks.size())
        return own_image(i, vertex);
    }
    fail(sibling, "a neighbour's ghost is none of its vertices");
  }

  void collect_ghosts() {
    for (std::size_t child = 0; child < children_.size(); ++child) {
      for (std::size_t ghost = 0; ghost < children_[child].ghosts.size(); ++ghost) {
        const GhostRef ref = raised(children_[child], ghost);
        if (ref.tile != parent_.index)
          ghosts_.push_back({ref, child, ghost});
      }
    }
    const auto order = [](const RaisedGhost& a, const RaisedGhost& b) { return a.ref < b.ref; };
    std::stable_sort(ghosts_.begin(), ghosts_.end(), order);
    const auto same = [](const RaisedGhost& a, const RaisedGhost& b) { return a.ref == b.ref; };
    ghosts_.erase(std::unique(ghosts_.begin(), ghosts_.end(), same), ghosts_.end());
  }

  void map_vertices(std::size_t number, const std::vector<GhostRef>& ghosts) {
    const TracedTile& child = children_[number];
    std::vector<TileVertex>& map = maps_.emplace_back();
    map.reserve(child.ranks.size() + child.ghosts.size());
    for (std::size_t vertex = 0; vertex < child.ranks.size(); ++vertex)
      map.push_back(vertex_of(own_image(number, vertex)));
    for (std::size_t ghost = 0; ghost < child.ghosts.size(); ++ghost) {
      const GhostRef ref = raised(child, ghost);
      const auto place = std::lower_bound(ghosts.begin(), ghosts.end(), ref);
      map.push_back(vertex_of(ref.tile == parent_.index
                                  ? ref.index
                                  : own_count_ + static_cast<std::size_t>(place - ghosts.begin())));
    }
  }

  const Tree& tree_;
  NodeId parent_;
  std::vector<TracedTile> children_;
  bool keep_;  ///< own vertices keep their numbers: an early node
  std::size_t own_count_ = 0;
  std::vector<RaisedGhost> ghosts_;
  std::vector<std::vector<TileVertex>> maps_;
};

/// A triangle that was raised to its image. The first original of several with one image stays,
/// whoever looks at them.
struct RaisedTriangle {
  TileTriangle key;  ///< the image, turned
  Triangle<std::uint64_t> order;
  TracedTriangle triangle;

  friend bool operator<(const RaisedTriangle& a, const RaisedTriangle& b) {
    return std::tie(a.key, a.order, a.triangle.index) < std::tie(b.key, b.order, b.triangle.index);
  }
};

Triangle<std::uint64_t> orders_of(const Sector& sector, const Triangle<std::uint32_t>& corners) {
  return {order_of(sector, corners[0]), order_of(sector, corners[1]), order_of(sector, corners[2])};
}

void lose(std::vector<TracedTriangle>& lost, Losses& losses) {
  const auto by_index = [](const TracedTriangle& a, const TracedTriangle& b) {
    return a.index < b.index;
  };
  std::sort(lost.begin(), lost.end(), by_index);
  for (const TracedTriangle& triangle : lost) {
    losses.triangles.push_back(triangle.index);
    losses.corners.push_back(triangle.corners);
  }
}

void raise_triangles(const Sector& sector, Raiser& raiser, Lifted& lifted) {
  std::vector<RaisedTriangle> raised;
  std::vector<TracedTriangle> lost;
  for (std::size_t child = 0; child < raiser.children().size(); ++child) {
    for (const TracedTriangle& t : raiser.children()[child].triangles) {
      const TileTriangle image = raiser.image_of(child, t.image);
      if (!is_degenerate(image)) {
        raised.push_back(
            {canonical(image), orders_of(sector, t.corners), {t.corners, image, t.index}});
      } else if (t.index != kCountedElsewhere) {
        lost.push_back(t);
      }
    }
  }
  std::sort(raised.begin(), raised.end());
  std::vector<TracedTriangle>& kept = lifted.tile.triangles;
  for (std::size_t i = 0; i < raised.size(); ++i) {
    // A triangle that both children have comes twice, the one with its number first; the other one
    // is no loss.
    if (i == 0 || raised[i].key != raised[i - 1].key) {
      kept.push_back(raised[i].triangle);
    } else if (raised[i].triangle.index != kCountedElsewhere) {
      lost.push_back(raised[i].triangle);
    }
  }
  lose(lost, lifted.losses);
}

/// A vertex of a child.
struct ChildVertex {
  std::uint32_t rank = 0;
  std::size_t child = 0;
  std::size_t vertex = 0;
};

/// Finds, for each vertex of the parent, the one that it is among those that it stands for: the
/// first at its place.
std::vector<ChildVertex> find_survivors(Raiser& raiser, const PublishedTile& parent) {
  std::vector<ChildVertex> survivors(parent.mesh.own_count, {UINT32_MAX, 0, 0});
  for (std::size_t child = 0; child < raiser.children().size(); ++child) {
    const TracedTile& from = raiser.children()[child];
    for (std::size_t vertex = 0; vertex < from.ranks.size(); ++vertex) {
      const std::uint16_t to = from.parent_map[vertex];
      // half_edge moves vertices onto one of their own, so the parent's vertex is at the place of
      // one that it stands for. If several were there, the least rank is the same for all who look.
      const bool stays = same_bits(parent.mesh.vertices.positions[to], from.values[vertex]);
      if (stays && from.ranks[vertex] < survivors[to].rank)
        survivors[to] = {from.ranks[vertex], child, vertex};
    }
  }
  for (std::size_t vertex = 0; vertex < survivors.size(); ++vertex) {
    if (survivors[vertex].rank == UINT32_MAX)
      fail(parent.node,
           "vertex " + std::to_string(vertex) +
               " is at the place of none that it stands for: half_edge leaves it there");
  }
  return survivors;
}

void raise_own(Raiser& raiser, const PublishedTile& parent, Lifted& lifted) {
  const std::vector<ChildVertex> survivors = find_survivors(raiser, parent);
  TracedTile& tile = lifted.tile;
  for (const ChildVertex& survivor : survivors) {
    tile.ranks.push_back(survivor.rank);
    tile.values.append(raiser.children()[survivor.child].values[survivor.vertex]);
  }
  std::vector<ChildVertex> lost;
  for (std::size_t child = 0; child < raiser.children().size(); ++child) {
    const TracedTile& from = raiser.children()[child];
    for (std::size_t vertex = 0; vertex < from.ranks.size(); ++vertex) {
      if (survivors[from.parent_map[vertex]].rank != from.ranks[vertex])
        lost.push_back({from.ranks[vertex], child, vertex});
    }
  }
  std::ranges::sort(lost, {}, &ChildVertex::rank);
  for (const ChildVertex& vertex : lost) {
    lifted.losses.ranks.push_back(vertex.rank);
    lifted.losses.values.append(raiser.children()[vertex.child].values[vertex.vertex]);
  }
}

void require_map(const TracedTile& child, std::size_t own_count) {
  const bool fits = child.parent_map.size() == child.ranks.size() &&
                    std::ranges::all_of(child.parent_map, [&](auto to) { return to < own_count; });
  if (!fits)
    fail(child.node, "its parent map does not fit the parent tile");
}

/// Returns the ranks of all vertices of a partition's tile.
std::vector<std::uint32_t> ranks_of(const Tree& tree, const PublishedTile& tile) {
  std::vector<std::uint32_t> ranks;
  const auto first = static_cast<std::uint32_t>(tree.ranks(tile.node).begin);
  for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i)
    ranks.push_back(first + i);
  for (const GhostRef& ghost : tile.mesh.ghosts) {
    const RankRange range = tree.ranks(NodeId{tree.depth(), ghost.tile});
    if (ghost.index >= range.size())
      fail(tile.node, "a ghost is none of its partition's vertices");
    ranks.push_back(static_cast<std::uint32_t>(range.begin + ghost.index));
  }
  return ranks;
}

/// Whether the partition is the first of the sector's that the triangle touches.
bool counts(const Sector& sector, const PublishedTile& tile, const TileTriangle& t) {
  return draws(tile.mesh, t, [&](std::size_t ghost) {
    const std::uint32_t partition = tile.mesh.ghosts[ghost].tile;
    return !sector.has_partition(partition) || draws_before(tile.node, partition, tile.node.level);
  });
}

}  // namespace

Triangle<std::uint32_t> sorted_corners(const Sector& sector,
                                       const Triangle<std::uint32_t>& corners) {
  return turned(corners, smallest_corner(orders_of(sector, corners)));
}

TracedTile trace_partition(const Tree& tree, const Sector& sector, const PublishedTile& tile,
                           std::uint64_t first_index) {
  const std::vector<std::uint32_t> ranks = ranks_of(tree, tile);
  TracedTile traced;
  traced.node = tile.node;
  traced.values = values_of(tile.mesh.vertices, tile.mesh.own_count);
  for (const auto* list : {&tile.mesh.interior, &tile.mesh.border}) {
    for (const TileTriangle& t : *list) {
      const Triangle<std::uint32_t> corners{ranks[raw(t[0])], ranks[raw(t[1])], ranks[raw(t[2])]};
      const std::size_t first = smallest_corner(orders_of(sector, corners));
      traced.triangles.push_back({turned(corners, first), turned(t, first),
                                  counts(sector, tile, t) ? 0 : kCountedElsewhere});
    }
  }
  std::ranges::stable_sort(traced.triangles, {},
                           [&](const TracedTriangle& t) { return orders_of(sector, t.corners); });
  traced.end_index = first_index;
  for (TracedTriangle& triangle : traced.triangles) {
    if (triangle.index != kCountedElsewhere)
      triangle.index = traced.end_index++;
  }
  traced.ranks.assign(ranks.begin(), ranks.begin() + tile.mesh.own_count);
  traced.ghosts = tile.mesh.ghosts;
  traced.chains = tile.chains;
  traced.parent_map = tile.parent_map;
  return traced;
}

Lifted lift_early(const Tree& tree, const Sector& sector, TracedTile partition) {
  Lifted lifted;
  lifted.tile.node = tree.parent(partition.node);
  lifted.tile.end_index = partition.end_index;
  const std::size_t own_count = partition.ranks.size();
  std::vector<TracedTile> children;
  children.push_back(std::move(partition));
  Raiser raiser(tree, lifted.tile.node, std::move(children), true);
  raiser.raise(own_count, lifted.tile);
  raise_triangles(sector, raiser, lifted);
  TracedTile& from = raiser.children().front();
  lifted.tile.ranks = std::move(from.ranks);
  lifted.tile.values = std::move(from.values);
  lifted.tile.parent_map = std::move(from.parent_map);
  lifted.losses.values.width = lifted.tile.values.width;
  return lifted;
}

Lifted lift(const Tree& tree, const Sector& sector, TracedTile left, TracedTile right,
            const PublishedTile& parent) {
  require_map(left, parent.mesh.own_count);
  require_map(right, parent.mesh.own_count);
  Lifted lifted;
  lifted.tile.node = parent.node;
  lifted.tile.end_index = right.end_index;
  lifted.tile.values.width = lifted.losses.values.width = left.values.width;
  std::vector<TracedTile> children;
  children.push_back(std::move(left));
  children.push_back(std::move(right));
  Raiser raiser(tree, parent.node, std::move(children), false);
  raiser.raise(parent.mesh.own_count, lifted.tile);
  raise_own(raiser, parent, lifted);
  raise_triangles(sector, raiser, lifted);
  lifted.tile.parent_map = parent.parent_map;
  const std::size_t shown = parent.mesh.interior.size() + parent.mesh.border.size();
  if (lifted.tile.triangles.size() != shown) {
    fail(parent.node, "has " + std::to_string(shown) + " triangles, of its children's " +
                          std::to_string(lifted.tile.triangles.size()) + " are left");
  }
  return lifted;
}

Losses all_of(const TracedTile& tile) {
  Losses all;
  std::vector<std::size_t> order(tile.ranks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t vertex) { return tile.ranks[vertex]; });
  all.values.width = tile.values.width;
  for (const std::size_t vertex : order) {
    all.ranks.push_back(tile.ranks[vertex]);
    all.values.append(tile.values[vertex]);
  }
  std::vector<TracedTriangle> triangles;
  std::ranges::copy_if(tile.triangles, std::back_inserter(triangles),
                       [](const auto& triangle) { return triangle.index != kCountedElsewhere; });
  lose(triangles, all);
  return all;
}

StandIns find_stand_ins(const Sector& sector, const TracedTile& tile) {
  StandIns found;
  const std::size_t own_count = tile.ranks.size();
  for (const TracedTriangle& triangle : tile.triangles) {
    for (std::size_t i = 0; i < triangle.corners.size(); ++i) {
      const std::uint32_t rank = triangle.corners[i];
      const std::uint32_t vertex = raw(triangle.image[i]);
      if (vertex < own_count) {
        if (tile.ranks[vertex] != rank)
          found.own.push_back({rank, vertex});
      } else if (!sector.has_rank(rank)) {
        found.foreign.push_back({rank, static_cast<std::uint32_t>(vertex - own_count)});
      }
    }
  }
  const auto sort = [](auto& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  sort(found.own);
  sort(found.foreign);
  return found;
}

}  // namespace meshhier::progressive
