// How files of other programs name a CRS.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::geodesy {

/// How a map projects the globe, by EPSG's codes of methods and of parameters.
struct MapMethod {
  int method = 0;  ///< 0: unknown
  struct Parameter {
    int code = 0;
    double value = 0;  ///< degrees; in the map's unit; a factor
  };
  std::vector<Parameter> parameters{};
  std::uint16_t geodetic = 0;  ///< code of its longitudes and latitudes; 0: it has none
  double equator = 0, inverse_flattening = 0;  ///< of their ellipsoid: metres; 0: a sphere
  double unit_metres = 1;                      ///< metres of the map's unit
};

struct MapCode {
  std::uint16_t horizontal = 0;  ///< EPSG's code of its horizontal part; 0: it has none
  std::uint16_t vertical = 0;    ///< the same of its heights; 0: it has none, or they are unknown
  std::string name;              ///< PROJ's, of the whole
  MapMethod method{};            ///< of the horizontal part, if that has no code
};

/// `crs`: as MapProjection has it. A CRS that is given by its definition has the code of the equal
/// one in PROJ's database, if there is one. Throws as MapProjection.
MapCode map_code(const std::string& crs);

}  // namespace meshhier::geodesy
