// A chunk: a node of the tree small enough to be split in memory, with all its triangles.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "hierarchy/tree.h"
#include "hierarchy/triangle.h"
#include "partition/direction.h"

#include <cstdint>
#include <vector>

namespace meshhier::partition {

/// Provisional ranks order the places by chunk, and by id within a chunk; the splits inside a
/// chunk make them final.
using RankTriangle = Triangle<std::uint32_t>;

struct ChunkMesh {
  NodeId node;
  VertexArray vertices;  ///< of each place the first, by id
  Copies copies;         ///< `places`: provisional ranks within the chunk
  std::vector<RankTriangle>
      triangles;  ///< every triangle with a corner in the chunk, provisional ranks, any order
  std::vector<CornerWedges> wedges;  ///< of the last triangles; those of all others are 0

  /// Returns the wedges of the triangle at that place in `triangles`.
  CornerWedges wedges_of(std::size_t triangle) const {
    const std::size_t before = triangles.size() - wedges.size();
    return triangle < before ? CornerWedges{} : wedges[triangle - before];
  }
};

/// The chunk that holds a rank. O(1).
class ChunkMap {
 public:
  ChunkMap(const Tree& tree, Level chunks);
  std::uint32_t count() const { return static_cast<std::uint32_t>(starts_.size() - 1); }
  std::uint32_t first_rank(std::uint32_t chunk) const {
    return static_cast<std::uint32_t>(starts_[chunk]);
  }
  std::uint32_t size(std::uint32_t chunk) const {
    return static_cast<std::uint32_t>(starts_[chunk + 1] - starts_[chunk]);
  }
  std::uint32_t chunk_of(std::uint32_t rank) const;

 private:
  std::vector<std::uint64_t> starts_;
};

/// The chunk of a rank, mostly that of the rank before.
class ChunkFinder {
 public:
  explicit ChunkFinder(const ChunkMap& map) : map_(map), size_(map.size(0)) {}

  std::uint32_t chunk_of(std::uint32_t rank) {
    if (rank - first_ >= size_) {
      chunk_ = map_.chunk_of(rank);
      first_ = map_.first_rank(chunk_);
      size_ = map_.size(chunk_);
    }
    return chunk_;
  }

 private:
  const ChunkMap& map_;
  std::uint32_t chunk_ = 0, first_ = 0, size_;
};

/// Splits a chunk down to partitions of exact sizes. Returns each vertex's partition. `longest`
/// splits at exact medians; `compactness` along short lines on the surface (graph_split.h), at
/// medians if no triangle lies within the chunk. Independent of the order of the triangles.
/// O(n log n) in its vertices and triangles. Holds up to 40 bytes a vertex and 56 a triangle
/// besides.
std::vector<PartitionId> split_chunk(const ChunkMesh& chunk, const Tree& tree, Axis axis);

}  // namespace meshhier::partition
