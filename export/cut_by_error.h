// Cuts by the estimated distance of their tiles from the original.
#pragma once

#include "hierarchy/cut.h"
#include "storage/format/hierarchy_reader.h"

#include <functional>

namespace meshhier::exporting {

/// The largest error of a tile, in input units.
struct LargestError {
  double error = 0;
};

/// Returns the coarsest tiles that are fine enough, with partitions where no other tile is. A tile
/// is asked only if none above it is fine enough. O(tiles of the cut).
Cut coarsest_cut(const storage::HierarchyReader& reader,
                 const std::function<bool(const TileRecord&)>& is_fine_enough);

/// Returns the coarsest tiles whose TileRecord::error, an estimate, is at most that, with
/// partitions where no other tile is. O(tiles of the cut).
Cut cut_by_error(const storage::HierarchyReader& reader, LargestError largest);

}  // namespace meshhier::exporting
