// A grid in degrees on a map that it is asked to stand on.
#pragma once

#include "mesh_io/cell_places.h"
#include "mesh_io/mosaic.h"

#include <memory>
#include <string>
#include <vector>

namespace meshhier::importing {

/// The CRS of a grid in degrees that names none.
inline constexpr const char* kPlainDegrees = "EPSG:4326";

struct TerrainMap {
  std::shared_ptr<const mesh_io::CellPlaces> places;  ///< of the cells, in metres
  std::vector<std::string> warnings;                  ///< a line each
};

/// Brings a grid in degrees to the map of `crs`. Throws Error(usage) if PROJ knows no such map, or
/// if a cell has no place there; Error(io) if PROJ is not there.
TerrainMap bring_to_map(const mesh_io::Mosaic& mosaic, const std::string& crs);

}  // namespace meshhier::importing
