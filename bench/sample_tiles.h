// Tiles as a build makes them, in memory, for measuring kernels one by one.
#pragma once

#include "bench/generator.h"
#include "cluster_simplify/seams.h"
#include "hierarchy/build_tile.h"
#include "hierarchy/tree.h"
#include "partition/chunk.h"
#include "partition/leaf_tiles.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::bench {

/// A mesh as the only chunk of its tree, which has as many partitions of at most
/// `partition_vertices` vertices as it takes. Requires a mesh of partition::kChunkVertices vertices
/// at most, and >= 1.
struct SampleChunk {
  SampleChunk(const GeneratedMesh& mesh, std::uint32_t partition_vertices);

  Tree tree;
  partition::ChunkMap map;
  partition::ChunkMesh chunk;
};

/// The partition tiles of a chunk, each ready to be resolved.
class SampleTiles {
 public:
  SampleTiles(const SampleChunk& sample, partition::Axis axis);

  std::uint32_t count() const { return static_cast<std::uint32_t>(leaves_.tiles.size()); }
  const LeafTile& work(std::uint32_t partition) const { return leaves_.tiles[partition]; }

  /// The places of a tile's foreign corners: one entry per work(partition).foreign.
  std::vector<GhostRef> mapped(std::uint32_t partition) const;

  /// The tile resolved, its ghosts filled.
  BuildTile resolved(std::uint32_t partition) const;

 private:
  partition::ChunkLeaves leaves_;
};

/// The tiles of partitions 2 * pair and 2 * pair + 1 joined.
BuildTile joined_pair(const SampleTiles& tiles, std::uint32_t pair);

}  // namespace meshhier::bench
