// Finds vertices that lie at one place, out of core.
//
// Problem. A soup, or a mesh with seams, has several vertices at one place. There may be billions,
// so no table of places fits into memory.
//
// Idea. Positions are spread over buckets by a hash of their bits; equal ones meet in one bucket,
// and each bucket is settled in memory, in the L2 cache if it is small enough:
//
//       vertices 0 1 2 3 ...  --hash-->  bucket 0: 0 7 9    -sort by place->  7=0, 9 alone
//       (blocks in parallel)             bucket 1: 1 4      (buckets in       4=1
//                                        bucket 2: 2 3 8     parallel)        none
//
// The copies that are found (id, first vertex of the place, how many there were before it) are
// sorted by id at the end. A bucket that is too large, as one place may have any number of
// vertices, is sorted externally.
//
// Invariant. Positions are compared themselves: no hash decides. At a place ids ascend, so the
// first vertex in the file stands for all, whatever the threads do.
//
// Cost. O(n) expected, each position is written and read once.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "import/copy_list.h"
#include "mesh_io/mesh_source.h"
#include "storage/io/spool.h"

#include <cstdint>

namespace meshhier::importing {

struct LookRoom {
  storage::ScratchFile& scratch;   ///< room for look_bytes()
  std::uint64_t memory_bytes = 0;  ///< besides the blocks, and the pool of the scratch file
  std::size_t blocks_in_flight = 1;
  execution::Progress& progress;  ///< advances by vertices
  const execution::CancelToken& cancel;
};

/// Returns the most that it has in the scratch file, about: each position with its id, and twice
/// the copies.
std::uint64_t look_bytes(const mesh_io::MeshDescription& mesh);

/// Returns the memory of a block of vertices in flight.
std::uint64_t look_block_bytes(const mesh_io::MeshDescription& mesh);

/// Finds the copies of a mesh; `list` gets them. Reads all vertices once, in parallel blocks if
/// they are in place. Positions are one place if their coordinates are equal as the file has them;
/// -0 equals 0. The result depends on the positions alone. O(n) expected, O(n log n) at worst.
/// Throws as mesh_io::MeshSource.
CopyList find_copies(mesh_io::MeshSource& source, storage::ScratchFile& list, const LookRoom& room);

}  // namespace meshhier::importing
