// The head of a text grid of ESRI, and the file beside it that names its CRS.
#pragma once

#include "mesh_io/height_raster.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace meshhier::mesh_io {

struct AscHead {
  std::uint32_t columns = 0, rows = 0;
  GridMap map;
  std::optional<double> absent;  ///< the number that stands for no height
  std::uint64_t bytes = 0;       ///< where the first height stands, or blanks before it
};

/// Reads the head. Throws Error(input) naming the file and what is missing or wrong.
AscHead read_asc_head(const storage::File& file);

/// Returns what WKT of ESRI or OGC tells of a map: its kind, its unit, and itself as the CRS.
/// MapKind::unknown if it is no WKT.
geodesy::RasterMap keys_of_wkt(std::string_view text);

}  // namespace meshhier::mesh_io
