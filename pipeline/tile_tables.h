// The tables of objects that tiles have (storage/format/tile_object_table.h), in the order in which
// tiles are written.
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/tile_objects.h"
#include "partition/rows_by_tile.h"
#include "pipeline/plan/stage_context.h"
#include "pipeline/tiles/forest.h"
#include "storage/format/object_table.h"
#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::pipeline {

class TileTables {
 public:
  /// Reads all `nodes` once, `in_flight` at a time, and then the rows of their objects from
  /// `table`, which must outlive this. Sorts in a file beside `scratch`. Throws Error(io | corrupt
  /// | interrupted).
  TileTables(const Forest& forest, std::span<const NodeId> nodes, const storage::ObjectTable& table,
             const storage::ScratchFile& scratch, std::size_t in_flight,
             const StageContext& context);

  /// Returns the table of the next node. For one thread at a time.
  TileObjects next();

 private:
  storage::ScratchFile scratch_;
  partition::RowsByTile rows_;
  const std::vector<ObjectProperty>& properties_;
  std::uint32_t next_ = 0;
};

}  // namespace meshhier::pipeline
