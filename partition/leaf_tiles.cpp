#include "partition/leaf_tiles.h"

#include "base/error.h"
#include "base/sort_few.h"
#include "partition/spatial_order.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <numeric>
#include <tuple>

namespace meshhier::partition {
namespace {

// A corner of an interior triangle takes 16 bits while they are sorted.
constexpr std::size_t kMostVertices = 65536;

constexpr std::uint32_t kOutside = 0xffffffff;  // the leaf of a corner in another chunk

class LeafBuilder {
 public:
  LeafBuilder(const ChunkMesh& chunk, std::span<const PartitionId> partition_of, const Tree& tree,
              const ChunkMap& chunks)
      : chunk_(chunk),
        chunks_(chunks),
        first_partition_(tree.partitions(chunk.node).begin),
        first_rank_(static_cast<std::uint32_t>(tree.ranks(chunk.node).begin)),
        places_(partition_of.size()),
        touched_(partition_of.size()),
        first_vertex_(tree.partitions(chunk.node).size() + 1) {
    for (std::size_t i = 0; i < places_.size(); ++i)
      places_[i].leaf = raw(partition_of[i]) - first_partition_;
    result_.tiles.resize(first_vertex_.size() - 1);
  }

  ChunkLeaves run() {
    mark_boundary();
    place_vertices();
    place_copies();
    divide_triangles();
    place_interior();
    place_borders();
    return std::move(result_);
  }

 private:
  // The kinds of triangles that a vertex has, as bits.
  static constexpr std::uint8_t kInner = 1, kBoundary = 2;

  struct Place {
    std::uint32_t leaf = 0;
    std::uint32_t index = 0;  ///< in the leaf's tile
  };
  /// An interior triangle, smallest corner first: that one's place among the vertices of all tiles,
  /// tile by tile, and the other two as one number.
  struct Interior {
    std::uint32_t row, rest;
  };
  std::uint32_t local(std::uint32_t rank) const { return rank - first_rank_; }
  /// Wraps around below the chunk's first rank.
  bool is_inside(std::uint32_t rank) const { return local(rank) < places_.size(); }
  std::uint32_t leaf(std::uint32_t rank) const {
    return is_inside(rank) ? places_[local(rank)].leaf : kOutside;
  }

  void mark_boundary() {
    for (const RankTriangle& t : chunk_.triangles) {
      const std::uint32_t a = leaf(t[0]), b = leaf(t[1]), c = leaf(t[2]);
      if (a == b && b == c) {
        touched_[local(t[0])] |= kInner;
        touched_[local(t[1])] |= kInner;
        touched_[local(t[2])] |= kInner;
        continue;
      }
      ++border_count_;
      for (const std::uint32_t rank : t) {
        if (is_inside(rank))
          touched_[local(rank)] |= kBoundary;
      }
    }
  }

  void place_vertices() {
    std::size_t boundaries = 0;
    for (std::size_t v = 0; v < places_.size(); ++v) {
      const bool is_boundary = (touched_[v] & kBoundary) != 0;
      ++first_vertex_[places_[v].leaf + 1];
      result_.tiles[places_[v].leaf].boundary_count += is_boundary ? 1 : 0;
      boundaries += is_boundary ? 1 : 0;
      result_.unreferenced_count += touched_[v] == 0 ? 1 : 0;
    }
    std::vector<std::uint32_t> next_boundary(result_.tiles.size()), next_inner;
    const auto channels = static_cast<std::size_t>(chunk_.vertices.channels);
    for (std::size_t i = 0; i < result_.tiles.size(); ++i) {
      LeafTile& tile = result_.tiles[i];
      const std::size_t size = first_vertex_[i + 1];
      assert(size <= kMostVertices);
      first_vertex_[i + 1] += first_vertex_[i];
      next_inner.push_back(tile.boundary_count);
      tile.vertices.channels = chunk_.vertices.channels;
      tile.vertices.positions.resize(size);
      tile.vertices.attributes.resize(size * channels);
      tile.history.weights.assign(size, 1.0F);
    }
    for (const std::uint32_t v : spatial_order(chunk_.vertices.positions)) {
      auto& [leaf, index] = places_[v];
      VertexArray& vertices = result_.tiles[leaf].vertices;
      index = ((touched_[v] & kBoundary) != 0 ? next_boundary : next_inner)[leaf]++;
      vertices.positions[index] = chunk_.vertices.positions[v];
      if (channels > 0) {
        const auto attributes = chunk_.vertices.attributes_of(v);
        std::copy(attributes.begin(), attributes.end(),
                  vertices.attributes.begin() + static_cast<std::ptrdiff_t>(index * channels));
      }
    }
    result_.places.reserve(boundaries);
    for (std::uint32_t v = 0; v < places_.size(); ++v) {
      if ((touched_[v] & kBoundary) != 0)
        result_.places.push_back({v, places_[v].leaf, places_[v].index});
    }
  }

  /// Tells interior from border triangles, degenerate ones from both.
  void divide_triangles() {
    interior_.reserve(chunk_.triangles.size() - border_count_);
    borders_.reserve(border_count_);
    rows_.assign(places_.size() + 1, 0);
    const std::size_t plain = chunk_.triangles.size() - chunk_.wedges.size();
    for (const RankTriangle& t : std::span(chunk_.triangles).first(plain)) {
      const std::uint32_t a = local(t[0]), b = local(t[1]), c = local(t[2]);
      if (a == b || b == c || c == a)
        continue;
      if (!is_inside(t[0]) || !is_inside(t[1]) || !is_inside(t[2]) ||
          places_[a].leaf != places_[b].leaf || places_[b].leaf != places_[c].leaf) {
        borders_.push_back(t);
        continue;
      }
      if (LeafTile& tile = result_.tiles[places_[a].leaf]; !tile.copies.empty()) {
        add_wedged(tile, t, {});
        continue;
      }
      const TileTriangle turned =
          canonical(TileTriangle{TileVertex{places_[a].index}, TileVertex{places_[b].index},
                                 TileVertex{places_[c].index}});
      const std::uint32_t row = first_vertex_[places_[a].leaf] + raw(turned[0]);
      interior_.push_back({row, raw(turned[1]) << 16 | raw(turned[2])});
      ++rows_[row + 1];
    }
    divide_wedged_triangles(plain);
  }

  /// Those from `first` on. The ones that have a place twice stay.
  void divide_wedged_triangles(std::size_t first) {
    first_wedged_border_ = borders_.size();
    for (std::size_t i = first; i < chunk_.triangles.size(); ++i) {
      const RankTriangle& t = chunk_.triangles[i];
      const std::uint32_t a = leaf(t[0]);
      if (a != kOutside && leaf(t[1]) == a && leaf(t[2]) == a) {
        add_wedged(result_.tiles[a], t, chunk_.wedges[i - first]);
      } else {
        borders_.push_back(t);
        border_wedges_.push_back(chunk_.wedges[i - first]);
      }
    }
    for (LeafTile& tile : result_.tiles)
      normalize_triangles(tile.interior, tile.interior_wedges, false);
  }
  /// An interior triangle of a tile with copies.
  void add_wedged(LeafTile& tile, const RankTriangle& t, const CornerWedges& wedges) const {
    tile.interior.push_back({vertex_of(t[0]), vertex_of(t[1]), vertex_of(t[2])});
    tile.interior_wedges.push_back(wedges);
  }
  TileVertex vertex_of(std::uint32_t rank) const { return TileVertex{places_[local(rank)].index}; }

  /// Copies go where their places went. Counts the vertices without a triangle.
  void place_copies() {
    if (chunk_.copies.empty())
      return;
    const std::vector<std::uint32_t>& places = chunk_.copies.places;
    std::vector<std::uint32_t> order(places.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto key = [&](std::uint32_t copy) {
        const Place& place = places_[places[copy]];
        return std::tuple(place.leaf, place.index, copy);
      };
      return key(a) < key(b);
    });
    for (LeafTile& tile : result_.tiles)
      tile.copies.vertices.channels = chunk_.vertices.channels;
    for (const std::uint32_t copy : order) {
      const Place& place = places_[places[copy]];
      Copies& copies = result_.tiles[place.leaf].copies;
      copies.places.push_back(place.index);
      copies.vertices.append(chunk_.copies.vertices.positions[copy],
                             chunk_.copies.vertices.attributes_of(copy));
    }
    result_.unreferenced_count = places_.size() + places.size() - count_used();
  }

  /// Vertices of the chunk that triangles use.
  std::uint64_t count_used() const {
    std::vector<bool> used(places_.size() + chunk_.copies.size());
    for (std::size_t i = 0; i < chunk_.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t place = local(chunk_.triangles[i][k]);
        const std::uint32_t wedge = chunk_.wedges_of(i)[k];
        if (place < places_.size())
          used[wedge == 0 ? place : places_.size() + chunk_.copies.first_of(place) + wedge - 1] =
              true;
      }
    }
    return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  }

  /// Sorts interior triangles by all corners: into rows of their first, then within the rows.
  void place_interior() {
    std::partial_sum(rows_.begin(), rows_.end(), rows_.begin());
    std::vector<std::uint32_t> sorted = interior_by_row();
    for (std::size_t i = 0; i < result_.tiles.size(); ++i) {
      if (!result_.tiles[i].copies.empty())
        continue;
      std::vector<TileTriangle>& triangles = result_.tiles[i].interior;
      const std::uint32_t first = first_vertex_[i], end = first_vertex_[i + 1];
      triangles.reserve(rows_[end] - rows_[first]);
      for (std::uint32_t row = first; row < end; ++row) {
        const auto rest = std::span(sorted).subspan(rows_[row], rows_[row + 1] - rows_[row]);
        sort_few(rest, std::identity{});
        for (const std::uint32_t two : rest)
          triangles.push_back(
              {TileVertex{row - first}, TileVertex{two >> 16}, TileVertex{two & 0xffff}});
      }
    }
  }

  /// The other two corners of each interior triangle, row after row. Forgets `interior_`.
  std::vector<std::uint32_t> interior_by_row() {
    std::vector<std::uint32_t> rest(interior_.size());
    std::vector<std::uint32_t> next(rows_.begin(), rows_.end() - 1);
    for (const Interior& triangle : interior_)
      rest[next[triangle.row]++] = triangle.rest;
    interior_ = {};
    return rest;
  }

  void place_borders() {
    for (std::size_t i = 0; i < borders_.size(); ++i) {
      const RankTriangle& t = borders_[i];
      const std::array<std::uint32_t, 3> leaves{leaf(t[0]), leaf(t[1]), leaf(t[2])};
      for (int k = 0; k < 3; ++k) {
        const bool repeated =
            (k > 0 && leaves[k] == leaves[0]) || (k > 1 && leaves[k] == leaves[1]);
        if (leaves[k] == kOutside || repeated)
          continue;
        LeafTile& tile = result_.tiles[leaves[k]];
        add_border(tile, leaves[k], t, leaves);
        if (!border_wedges_.empty())
          tile.border_wedges.push_back(
              i < first_wedged_border_ ? CornerWedges{} : border_wedges_[i - first_wedged_border_]);
      }
    }
    std::vector<std::uint32_t> number(places_.size());
    for (LeafTile& tile : result_.tiles)
      finish(tile, number);
  }

  void add_border(LeafTile& tile, std::uint32_t own, const RankTriangle& t,
                  const std::array<std::uint32_t, 3>& leaves) {
    TileTriangle border;
    for (int k = 0; k < 3; ++k) {
      if (leaves[k] == own) {
        border[k] = TileVertex{places_[local(t[k])].index};
        continue;
      }
      const std::uint32_t chunk =
          leaves[k] == kOutside ? chunks_.chunk_of(t[k]) : chunk_.node.index;
      border[k] = static_cast<TileVertex>(tile.vertices.size() + tile.foreign.size());
      tile.foreign.push_back({chunk, t[k] - chunks_.first_rank(chunk)});
    }
    tile.border.push_back(border);
  }

  /// Makes the foreign corners unique and brings everything into an order that the triangles' order
  /// does not show in. `number`: one entry a vertex of the chunk, any content.
  void finish(LeafTile& tile, std::span<std::uint32_t> number) const {
    const auto own_count = static_cast<std::uint32_t>(tile.vertices.size());
    std::vector<ChunkVertex> unique = sorted_unique(tile.foreign, number);
    const auto near = std::equal_range(
        unique.begin(), unique.end(), ChunkVertex{chunk_.node.index, 0},
        [](const ChunkVertex& a, const ChunkVertex& b) { return a.chunk < b.chunk; });
    for (auto ref = near.first; ref != near.second; ++ref)
      number[ref->local] = static_cast<std::uint32_t>(ref - unique.begin());
    for (TileTriangle& t : tile.border) {
      for (TileVertex& corner : t) {
        if (raw(corner) < own_count)
          continue;
        const ChunkVertex& ref = tile.foreign[raw(corner) - own_count];
        const std::uint32_t place =
            ref.chunk == chunk_.node.index
                ? number[ref.local]
                : static_cast<std::uint32_t>(std::lower_bound(unique.begin(), unique.end(), ref) -
                                             unique.begin());
        corner = TileVertex{own_count + place};
      }
    }
    tile.foreign = std::move(unique);
    if (std::ranges::all_of(tile.border_wedges,
                            [](const CornerWedges& w) { return w == CornerWedges{}; }))
      tile.border_wedges.clear();
    normalize_triangles(tile.border, tile.border_wedges, false);
  }

  /// `places`: as in finish().
  std::vector<ChunkVertex> sorted_unique(std::span<const ChunkVertex> refs,
                                         std::span<std::uint32_t> places) const {
    std::vector<ChunkVertex> unique;
    for (const ChunkVertex& ref : refs) {
      if (ref.chunk == chunk_.node.index) {
        const std::uint32_t place = places[ref.local];
        if (place < unique.size() && unique[place] == ref)
          continue;
        places[ref.local] = static_cast<std::uint32_t>(unique.size());
      }
      unique.push_back(ref);
    }
    std::sort(unique.begin(), unique.end());
    unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
    return unique;
  }

  const ChunkMesh& chunk_;
  const ChunkMap& chunks_;
  std::uint32_t first_partition_;
  std::uint32_t first_rank_;
  std::vector<Place> places_;
  std::vector<std::uint8_t> touched_;
  std::vector<std::uint32_t> first_vertex_;  ///< of each tile, among the vertices of all
  std::size_t border_count_ = 0;
  std::vector<RankTriangle> borders_;
  std::vector<CornerWedges> border_wedges_;  ///< of the last ones
  std::size_t first_wedged_border_ = 0;
  std::vector<Interior> interior_;
  std::vector<std::uint32_t> rows_;  ///< of interior triangles, by their first corner
  ChunkLeaves result_;
};

}  // namespace

ChunkLeaves build_leaves(const ChunkMesh& chunk, std::span<const PartitionId> partition_of,
                         const Tree& tree, const ChunkMap& chunks) {
  return LeafBuilder(chunk, partition_of, tree, chunks).run();
}

const LeafPlace& find_place(std::span<const LeafPlace> places, std::uint32_t local) {
  const auto found = std::lower_bound(
      places.begin(), places.end(), local,
      [](const LeafPlace& place, std::uint32_t value) { return place.local < value; });
  if (found == places.end() || found->local != local) {
    throw Error(ErrorCode::internal, "a border triangle's corner is not in its chunk's boundary");
  }
  return *found;
}

}  // namespace meshhier::partition
