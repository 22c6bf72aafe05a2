// The region that options of commands ask for.
#pragma once

#include "base/bounds.h"
#include "execution/cancel.h"
#include "export/asked_objects.h"
#include "export/region.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace meshhier::exporting {

struct RegionRequest {
  /// In the input's coordinates, or with `crs` in x and y of that map and heights of the input.
  std::optional<BoundsD> box{};
  std::filesystem::path polygon{};  ///< GeoJSON, seen along the hierarchy's up axis; empty: none
  std::string crs{};                ///< the map's; empty: coordinates are the input's
  ObjectRequest objects{};          ///< nothing but these

  bool has_border() const { return box || !polygon.empty(); }
  bool is_any() const { return has_border() || objects.is_any(); }
  /// Returns a name for people: "box", "polygon", "box and objects".
  std::string name() const;
};

/// Returns the region relative to the hierarchy's origin. `files` has the polygon. Throws
/// Error(usage) if the box is none, and as read_polygons(), config::MapPlaces and AskedObjects. The
/// region looks at `cancel`, which must outlive it, while it cuts.
Region region_of(storage::FileSystem& files, const storage::HierarchyReader& reader,
                 const RegionRequest& request, const execution::CancelToken& cancel);

/// Throws Error(usage), which says that nothing of the mesh lies there, and where the mesh lies.
[[noreturn]] void fail_empty(const storage::HierarchyReader& reader, const RegionRequest& request);

}  // namespace meshhier::exporting
