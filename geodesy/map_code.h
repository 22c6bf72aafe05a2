// How files of other programs name a CRS.
#pragma once

#include <cstdint>
#include <string>

namespace meshhier::geodesy {

struct MapCode {
  std::uint16_t horizontal = 0;  ///< EPSG's code of its horizontal part; 0: it has none
  std::uint16_t vertical = 0;    ///< the same of its heights; 0: it has none, or they are unknown
  std::string name;              ///< PROJ's, of the whole
  std::string wkt{};             ///< ESRI's WKT of the horizontal part, if that has no code
};

/// `crs`: as MapProjection has it. A CRS that is given by its definition has the code of the equal
/// one in PROJ's database, if there is one. Throws as MapProjection.
MapCode map_code(const std::string& crs);

}  // namespace meshhier::geodesy
