// Polygons of GeoJSON (RFC 7946).
#pragma once

#include "export/plan_region.h"
#include "storage/io/file.h"

#include <filesystem>
#include <vector>

namespace meshhier::exporting {

/// Reads the polygons of a geometry, a feature or a collection of these, whatever CRS its
/// coordinates are in; heights and geometries of other kinds are passed over. Throws Error(input)
/// naming the file if it is no GeoJSON, is larger than 64 MiB or has no polygon; Error(budget) if
/// its JSON takes more than 1 GiB of memory; Error(io).
std::vector<PlanPolygon> read_polygons(storage::FileSystem& files,
                                       const std::filesystem::path& path);

}  // namespace meshhier::exporting
