// The keys of GeoTIFF (OGC 19-008r4): which map a raster lies in.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace meshhier::geodesy {

/// The three tags that hold keys.
struct GeoKeyTags {
  std::span<const std::uint16_t> directory;
  std::span<const double> doubles;
  std::string_view text;
};

/// The kind of coordinates that the rows and columns of a raster lie in.
enum class MapKind : std::uint8_t { unknown, lengths, degrees };

struct RasterMap {
  MapKind kind = MapKind::unknown;
  /// The CRS for PROJ: "EPSG:32633", "EPSG:32633+5773", WKT; empty if there is none, or only one
  /// that the file defines by parameters.
  std::string crs;
  bool is_user_defined = false;  ///< the file defines a CRS by parameters
  /// Metres, or degrees, of one unit of the horizontal coordinates.
  double unit = 1;
  /// Metres of one unit of heights, if the keys tell.
  std::optional<double> height_unit;
  bool is_point = false;  ///< a place of the raster is the middle of a cell, not its corner
};

/// Returns a CRS by its code without its heights: "EPSG:32633" of "EPSG:32633+5773"; another one as
/// it is.
std::string horizontal_code(const std::string& crs);

/// Reads the keys; a file without them has RasterMap{}. Throws Error(input) in a few words if keys
/// contradict the tags, or name a unit that is not known, or geocentric coordinates.
RasterMap raster_map_of(const GeoKeyTags& tags);

/// Returns the metres of a unit of length by its code in EPSG's list; nothing if it is not known.
std::optional<double> metres_of_unit(std::uint16_t code);

}  // namespace meshhier::geodesy
