// The keys by which a GeoTIFF names its map (OGC 19-008r4).
//
// A map with a code of EPSG has that. Others have their method and its parameters, as far as
// GeoTIFF knows the method. A plane that touches the globe is a transverse Mercator map around the
// point where it does.
#pragma once

#include "geodesy/map_code.h"

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::geodesy {

/// The values of the three tags; all empty: no map.
struct GeoKeys {
  std::vector<std::uint16_t> directory{};  ///< GeoKeyDirectoryTag, 34735
  std::vector<double> doubles{};           ///< GeoDoubleParamsTag, 34736; may be empty
  std::string text{};                      ///< GeoAsciiParamsTag, 34737; may be empty
};

/// Returns the keys of a projected map; none if it has no code and a method that GeoTIFF does not
/// know. `has_heights`: the raster's numbers are the map's heights.
GeoKeys keys_of_map(const MapCode& code, bool has_heights);

/// A plane above WGS 84 that is level at one point of it.
struct LevelPlane {
  double longitude = 0, latitude = 0;  ///< of the point, degrees
  double scale = 1;                    ///< lengths in the plane, over those on the ellipsoid
};
/// Returns the keys of the plane's metres to the east and to the north of the point.
GeoKeys keys_of_plane(const LevelPlane& plane);

}  // namespace meshhier::geodesy
