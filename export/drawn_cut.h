// What rasters and drawings show of a hierarchy: a cut, or its part in a region, tile by tile.
#pragma once

#include "base/bounds.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "export/cut_part.h"
#include "export/map_frame.h"
#include "hierarchy/cut.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace meshhier::exporting {

/// Thread-safe. What it refers to must outlive it.
struct DrawnCut {
  const storage::HierarchyReader& reader;
  Cut cut;
  std::optional<Region> region;
  const execution::CancelToken& cancel;

  /// Returns what a tile draws within the region; `parts`: of the cut. Throws as CutParts::load()
  /// and clip_part().
  CutPart load(CutParts& parts, std::size_t tile) const;
};

/// Cuts at work: one for each item in flight, as each is for one thread.
class Benches {
 public:
  Benches(const DrawnCut& shown, std::size_t count, std::uint64_t cache_bytes);
  std::size_t size() const { return parts_.size(); }
  CutParts& of(std::size_t item) { return *parts_[item % parts_.size()]; }

 private:
  std::vector<std::unique_ptr<CutParts>> parts_;
};

/// Throws Error(usage) if the hierarchy has points alone. `what`: "a raster".
void require_surface(const storage::HierarchyReader& reader, const char* what);

/// Returns the box of what each tile of the cut draws; an empty one if that is nothing. Where
/// levels meet, a tile reaches to the vertices of its coarser neighbour, which its record does not
/// tell: it is read.
std::vector<BoundsD> boxes_of(const DrawnCut& shown, Benches& benches,
                              execution::Progress& progress);

/// Returns the box in `frame` of all that may be drawn. On axes of its own a box around small boxes
/// is closer than one around all. `region`: of `request`. Tiles that lie out of `kept` do not
/// count, if there is one. O(tiles).
BoundsD drawn_box(const storage::HierarchyReader& reader, const MapFrame& frame,
                  const RegionRequest& request, const std::optional<Region>& region,
                  const ConvexRegion* kept = nullptr);

}  // namespace meshhier::exporting
