// The region that options of commands ask for.
#pragma once

#include "execution/cancel.h"
#include "export/region.h"
#include "hierarchy/bounds.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::exporting {

struct RegionRequest {
  /// In the input's coordinates; of a map instead its x and y, and heights of the input.
  std::optional<BoundsD> box{};
  std::filesystem::path polygon{};  ///< GeoJSON, seen along the hierarchy's up axis; empty: none
  std::string crs{};                ///< of the map; empty: coordinates are the input's

  bool is_any() const { return box || !polygon.empty(); }
  /// For people: "box", "polygon".
  std::string name() const;
};

/// Relative to the hierarchy's origin. `files`: where the polygon lies. Throws Error(usage) if the
/// box is none, and as read_polygons() and config::MapPlaces. The region looks at `cancel`, which
/// must outlive it, while it cuts.
Region region_of(storage::FileSystem& files, const storage::HierarchyReader& reader,
                 const RegionRequest& request, const execution::CancelToken& cancel);

/// Throws Error(usage): nothing of the mesh lies there, and where it does.
[[noreturn]] void fail_empty(const storage::HierarchyReader& reader, const RegionRequest& request);

}  // namespace meshhier::exporting
