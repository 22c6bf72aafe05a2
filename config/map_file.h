// The files that photogrammetry programs write beside a model whose coordinates they have shifted:
// the map's reference system (CRS), and the offset that was taken off each coordinate.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::config {

/// A place on the ellipsoid, in degrees.
struct MapPlace {
  double latitude = 0, longitude = 0;
  std::optional<double> height{};  ///< metres above the ellipsoid
  friend bool operator==(const MapPlace&, const MapPlace&) = default;
};

struct MapFile {
  std::optional<std::string> crs;
  std::optional<std::array<double, 3>> offset;
  /// Instead of a crs: coordinates go east, north and up from there.
  std::optional<MapPlace> place{};
  bool is_local = false;  ///< it says that coordinates belong to no map
};

/// Reads one of these, of which nobody knows who wrote it:
///
///   metadata.xml   <SRS>EPSG:32633</SRS> and <SRSOrigin>500000,5300000,0</SRSOrigin>; WKT in SRS
///                  may have the five entities of XML, no others; <SRS>ENU:48.1,11.6</SRS> is a
///                  place, also with a height; <SRS>LOCAL…, an empty SRS and none are no map
///   coords.txt     a line "WGS84 UTM 32N", or one that PROJ takes, then one of two or three
///                  numbers; the rest is not read
///   offset.xyz     three numbers
///   scan.prj       WKT
///
/// Numbers lie between blanks, commas or semicolons; without a third one, it is 0. Throws
/// Error(usage) with what is expected if the text is none of them.
MapFile parse_map_file(std::string_view text);

}  // namespace meshhier::config
