// Partition tiles out of a split chunk.
#pragma once

#include "hierarchy/build_tile.h"
#include "partition/chunk.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// Where a boundary vertex of a chunk went: the bridge from provisional ranks to tile vertices.
struct LeafPlace {
  std::uint32_t local = 0;      ///< provisional rank within the chunk
  std::uint32_t partition = 0;  ///< counted from the chunk's first partition
  std::uint32_t index = 0;      ///< in that partition's tile, in its boundary
};

struct ChunkLeaves {
  std::vector<LeafTile> tiles;           ///< of the chunk's partitions, in order
  std::vector<LeafPlace> places;         ///< every boundary vertex, ascending by `local`
  std::uint64_t unreferenced_count = 0;  ///< vertices without a triangle
};

/// Builds the partition tiles, of at most 65,536 vertices each: vertices by id, boundary first; a
/// border triangle goes to each partition it touches; its foreign corners are vertices
/// of chunks. Independent of the order of the triangles.
ChunkLeaves build_leaves(const ChunkMesh& chunk, std::span<const PartitionId> partition_of,
                         const Tree& tree, const ChunkMap& chunks);

/// Looks a foreign corner of a leaf up in its chunk's places. Throws Error(internal) if it is not
/// there.
const LeafPlace& find_place(std::span<const LeafPlace> places, std::uint32_t local);

}  // namespace meshhier::partition
