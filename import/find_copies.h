// Which vertices lie at one place, out of core.
//
// Positions are spread over buckets by a hash of their bits, and each bucket is settled in memory;
// one that is too large is sorted externally. Positions are compared themselves: no hash decides.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "import/copy_list.h"
#include "mesh_io/mesh_source.h"
#include "storage/io/spool.h"

#include <cstdint>

namespace meshhier::importing {

struct LookRoom {
  storage::ScratchFile& scratch;   ///< for look_bytes()
  std::uint64_t memory_bytes = 0;  ///< besides the blocks, and what the pool holds of the scratch
  std::size_t blocks_in_flight = 1;
  execution::Progress& progress;  ///< advances by vertices
  const execution::CancelToken& cancel;
};

/// About what it has in scratch at most: each position with its id, and twice the copies.
std::uint64_t look_bytes(const mesh_io::MeshDescription& mesh);

/// Memory of a block of vertices in flight.
std::uint64_t look_block_bytes(const mesh_io::MeshDescription& mesh);

/// Reads all vertices once, in parallel blocks if they are in place. Positions are one place if
/// their coordinates are equal as the file has them; -0 equals 0. The result depends on the
/// positions alone. O(n) expected, O(n log n) at worst. Throws as mesh_io::MeshSource.
CopyList find_copies(mesh_io::MeshSource& source, storage::ScratchFile& list, const LookRoom& room);

}  // namespace meshhier::importing
