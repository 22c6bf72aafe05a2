// Makes partition tiles out of a split chunk.
//
//      a triangle's corners are in ...     it goes to                 named there
//      partition 0                         tile 0, interior           by tile vertices
//      partitions 0 and 1                  tiles 0 and 1, border      own ones likewise, others by
//      partition 1 and another chunk       tile 1, border               (chunk, provisional rank)
//
// A tile numbers its boundary vertices first, then the others, both along a space-filling curve.
// Foreign corners are found by `places` when all chunks are done (find_place()).
//
// Invariant. The result depends on the mesh and the split alone: what is made in the triangles'
// order is sorted before it is handed out. Degenerate triangles are dropped, exact duplicates stay:
// partitions together are the input.
//
// Cost. O(n log n) only along borders: interior triangles are sorted by counting their first
// corners, and a few at a time by the other two.
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

/// Builds the partition tiles, of at most 65,536 vertices each. Independent of the order of the
/// triangles. Pure; may be called by many threads.
ChunkLeaves build_leaves(const ChunkMesh& chunk, std::span<const PartitionId> partition_of,
                         const Tree& tree, const ChunkMap& chunks);

/// Looks a foreign corner of a leaf up in its chunk's places. Throws Error(internal) if it is not
/// there.
const LeafPlace& find_place(std::span<const LeafPlace> places, std::uint32_t local);

}  // namespace meshhier::partition
