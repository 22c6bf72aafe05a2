#include "mesh_io/geotiff_place.h"

#include "base/error.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

namespace meshhier::mesh_io {
namespace {

/// Returns the map from the tags that give one. `half`: half a cell if places are corners of cells.
GridMap grid_map_of(images::TiffFile& tiff, double half) {
  const auto matrix = tiff.doubles(images::GeoTag::transformation);
  const auto scale = tiff.doubles(images::GeoTag::pixel_scale);
  const auto ties = tiff.doubles(images::GeoTag::tie_points);
  constexpr std::size_t kMatrix = 16, kTie = 6;
  GridMap map;
  if (matrix.size() >= kMatrix) {
    map = {{matrix[3], matrix[7]}, {matrix[0], matrix[4]}, {matrix[1], matrix[5]}};
  } else if (scale.size() >= 2 && ties.size() >= kTie) {
    map = {{ties[3] - ties[0] * scale[0], ties[4] + ties[1] * scale[1]},
           {scale[0], 0},
           {0, -scale[1]}};
  } else {
    tiff.fail(
        ties.size() > kTie
            ? "has control points in place of a grid; `gdalwarp` makes a grid of it"
            : "does not say where its cells lie; `gdal_translate -a_srs ... -a_ullr ...` does");
  }
  map.first = map.at(half, half);
  return map;
}

void require_map(const GridMap& map, images::TiffFile& tiff) {
  const auto finite = [](MapPoint p) { return std::isfinite(p.x) && std::isfinite(p.y); };
  if (!finite(map.first) || !finite(map.column) || !finite(map.row) ||
      !(std::abs(map.determinant()) > 0))
    tiff.fail("has a transformation without an area: its cells lie nowhere");
}

geodesy::RasterMap geo_keys_of(images::TiffFile& tiff) {
  const auto directory = tiff.shorts(images::GeoTag::key_directory);
  const auto doubles = tiff.doubles(images::GeoTag::double_params);
  const std::string text = tiff.text(images::GeoTag::ascii_params);
  try {
    return geodesy::raster_map_of({directory, doubles, text});
  } catch (const Error& error) {
    tiff.fail(error.what());
  }
}

}  // namespace

GeoTiffPlace read_place(images::TiffFile& tiff) {
  GeoTiffPlace place;
  place.keys = geo_keys_of(tiff);
  place.map = grid_map_of(tiff, place.keys.is_point ? 0 : 0.5);
  require_map(place.map, tiff);
  return place;
}

}  // namespace meshhier::mesh_io
