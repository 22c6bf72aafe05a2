#include "partition/leaf_tiles.h"

#include "hierarchy/error.h"

#include <algorithm>

namespace meshhier::partition {
namespace {

constexpr std::uint32_t kOutside = 0xffffffff;  // the leaf of a corner in another chunk

class LeafBuilder {
 public:
  LeafBuilder(const ChunkMesh& chunk, std::span<const PartitionId> partition_of, const Tree& tree,
              const ChunkMap& chunks)
      : chunk_(chunk),
        chunks_(chunks),
        first_partition_(tree.partitions(chunk.node).begin),
        first_rank_(static_cast<std::uint32_t>(tree.ranks(chunk.node).begin)),
        leaf_of_(partition_of.size()),
        index_of_(partition_of.size()),
        touched_(partition_of.size()) {
    for (std::size_t i = 0; i < leaf_of_.size(); ++i)
      leaf_of_[i] = raw(partition_of[i]) - first_partition_;
    result_.tiles.resize(tree.partitions(chunk.node).size());
  }

  ChunkLeaves run() {
    mark_rim();
    place_vertices();
    for (const RankTriangle& t : chunk_.triangles)
      place_triangle(t);
    for (WorkTile& tile : result_.tiles)
      finish(tile);
    return std::move(result_);
  }

 private:
  enum Touch : char { kUnreferenced = 0, kInner = 1, kRim = 2 };

  std::uint32_t local(std::uint32_t rank) const { return rank - first_rank_; }
  std::uint32_t leaf(std::uint32_t rank) const {
    const std::uint32_t vertex = local(rank);  // wraps around below the chunk's first rank
    return vertex < leaf_of_.size() ? leaf_of_[vertex] : kOutside;
  }

  void mark_rim() {
    for (const RankTriangle& t : chunk_.triangles) {
      const bool interior = leaf(t[0]) == leaf(t[1]) && leaf(t[1]) == leaf(t[2]);
      for (const std::uint32_t rank : t) {
        if (leaf(rank) != kOutside)
          touched_[local(rank)] = std::max(touched_[local(rank)], interior ? kInner : kRim);
      }
    }
  }

  void place_vertices() {
    std::vector<std::uint32_t> size(result_.tiles.size());
    for (std::size_t v = 0; v < leaf_of_.size(); ++v) {
      ++size[leaf_of_[v]];
      if (touched_[v] == kRim)
        ++result_.tiles[leaf_of_[v]].rim_count;
      if (touched_[v] == kUnreferenced)
        ++result_.unreferenced_count;
    }
    for (std::size_t i = 0; i < size.size(); ++i) {
      WorkTile& tile = result_.tiles[i];
      tile.vertices.channels = chunk_.vertices.channels;
      tile.vertices.positions.resize(size[i]);
      tile.vertices.attributes.resize(size[i] * static_cast<std::size_t>(chunk_.vertices.channels));
      tile.history.weights.assign(size[i], 1.0F);
    }
    std::vector<std::uint32_t> next_rim(result_.tiles.size());
    std::vector<std::uint32_t> next_inner(result_.tiles.size());
    for (std::uint32_t v = 0; v < leaf_of_.size(); ++v) {
      const std::uint32_t leaf = leaf_of_[v];
      WorkTile& tile = result_.tiles[leaf];
      const bool rim = touched_[v] == kRim;
      index_of_[v] = rim ? next_rim[leaf]++ : tile.rim_count + next_inner[leaf]++;
      if (rim)
        result_.places.push_back({v, leaf, index_of_[v]});
      tile.vertices.positions[index_of_[v]] = chunk_.vertices.positions[v];
      const auto attributes = chunk_.vertices.attributes_of(v);
      std::copy(attributes.begin(), attributes.end(),
                tile.vertices.attributes.begin() +
                    static_cast<std::ptrdiff_t>(index_of_[v] * attributes.size()));
    }
  }

  void place_triangle(const RankTriangle& t) {
    const std::array<std::uint32_t, 3> leaves{leaf(t[0]), leaf(t[1]), leaf(t[2])};
    if (leaves[0] == leaves[1] && leaves[1] == leaves[2]) {
      Triangle interior;
      for (int k = 0; k < 3; ++k)
        interior[k] = static_cast<TileVertex>(index_of_[local(t[k])]);
      result_.tiles[leaves[0]].interior.push_back(interior);
      return;
    }
    for (int k = 0; k < 3; ++k) {
      const bool repeated = (k > 0 && leaves[k] == leaves[0]) || (k > 1 && leaves[k] == leaves[1]);
      if (leaves[k] != kOutside && !repeated)
        add_border(result_.tiles[leaves[k]], leaves[k], t, leaves);
    }
  }

  void add_border(WorkTile& tile, std::uint32_t own, const RankTriangle& t,
                  const std::array<std::uint32_t, 3>& leaves) {
    Triangle border;
    for (int k = 0; k < 3; ++k) {
      if (leaves[k] == own) {
        border[k] = static_cast<TileVertex>(index_of_[local(t[k])]);
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
  /// does not show in.
  static void finish(WorkTile& tile) {
    const auto own_count = static_cast<std::uint32_t>(tile.vertices.size());
    std::vector<GhostRef> unique = tile.foreign;
    std::sort(unique.begin(), unique.end());
    unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
    for (Triangle& t : tile.border) {
      for (TileVertex& corner : t) {
        if (raw(corner) < own_count)
          continue;
        const auto found =
            std::lower_bound(unique.begin(), unique.end(), tile.foreign[raw(corner) - own_count]);
        corner =
            static_cast<TileVertex>(own_count + static_cast<std::uint32_t>(found - unique.begin()));
      }
    }
    tile.foreign = std::move(unique);
    normalize_triangles(tile.interior, false);
    normalize_triangles(tile.border, false);
  }

  const ChunkMesh& chunk_;
  const ChunkMap& chunks_;
  std::uint32_t first_partition_;
  std::uint32_t first_rank_;
  std::vector<std::uint32_t> leaf_of_;
  std::vector<std::uint32_t> index_of_;
  std::vector<Touch> touched_;
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
    throw Error(ErrorCode::internal, "a border triangle's corner is not in its chunk's rim");
  }
  return *found;
}

}  // namespace meshhier::partition
