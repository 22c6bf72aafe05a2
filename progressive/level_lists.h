// Lists of the vertices and triangles that the levels of a sector lose, and of vertices that stand
// for others, on the way into the files of a progressive stream.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/tree.h"
#include "hierarchy/triangle.h"
#include "progressive/traced_tile.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <vector>

namespace meshhier::progressive {

/// A triangle of the original mesh. Its index is in two halves, so that there is no padding.
struct LostTriangle {
  std::uint32_t index_low = 0;
  std::uint32_t index_high = 0;
  Triangle<std::uint32_t> corners{};  ///< ranks

  std::uint64_t index() const { return std::uint64_t{index_high} << 32 | index_low; }
};

/// A vertex that a level's triangles have for a corner, and the level's vertex in its stead.
struct StandIn {
  std::uint32_t rank = 0;
  std::uint32_t stands = 0;  ///< rank
};

/// The lists of one level; values are vertex_values() an entry.
struct LevelLists {
  explicit LevelLists(storage::ScratchFile& scratch);

  // These ascend. The sector's own level has all that is left there.
  storage::RecordSpool<std::uint32_t> lost_ranks;  ///< vertices that the next coarser level has not
  storage::RecordSpool<float> lost_values;
  storage::RecordSpool<LostTriangle> lost_triangles;
  storage::RecordSpool<StandIn> stand_ins;  ///< for corners that the level has not
  storage::RecordSpool<float> stand_in_values;
  // These come as the tiles tell of them, with repeats.
  storage::RecordSpool<std::uint32_t> foreign_ranks;  ///< corners that are not the sector's
  storage::RecordSpool<float> foreign_values;         ///< those of the vertices in their stead
};

struct TraceOptions {
  std::vector<bool> listed;  ///< by level: whether its stand-ins and foreign corners are wanted
  Level subtrees{};          ///< a complete level, whose nodes are worked on in parallel
  std::size_t in_flight = 1;
};

/// Follows all tiles of `sector` up (progressive/traced_tile.h), and fills `lists`, one for each
/// level of the tree. Each tile is read once, in parallel. Deterministic. Throws Error(corrupt) if
/// the hierarchy was not made by half_edge, Error(io | interrupted).
void trace_sector(const storage::HierarchyReader& reader, const progressive::Sector& sector,
                  const TraceOptions& options, std::vector<LevelLists>& lists,
                  execution::Progress& progress, const execution::CancelToken& cancel);

}  // namespace meshhier::progressive
