// Cuts by what their tiles are from the original.
#pragma once

#include "hierarchy/cut.h"
#include "storage/format/hierarchy_reader.h"

namespace meshhier::exporting {

/// Tiles that are no farther from the original than this, input units; the coarsest that do.
struct LargestError {
  double error = 0;
};

/// O(tiles of the cut).
Cut cut_by_error(const storage::HierarchyReader& reader, LargestError largest);

}  // namespace meshhier::exporting
