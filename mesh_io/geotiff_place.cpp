#include "mesh_io/geotiff_place.h"

#include "base/error.h"
#include "images/tiff_pixels.h"
#include "mesh_io/beside_raster.h"
#include "mesh_io/coordinate_range.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace meshhier::mesh_io {
namespace {

/// Returns the places of the corners of pixels, or of their middles, as the keys say; nothing if
/// the tags tell none.
std::optional<GridMap> told_grid(images::TiffFile& tiff) {
  const auto matrix = tiff.doubles(images::GeoTag::transformation);
  const auto scale = tiff.doubles(images::GeoTag::pixel_scale);
  const auto ties = tiff.doubles(images::GeoTag::tie_points);
  constexpr std::size_t kMatrix = 16, kTie = 6;
  if (matrix.size() >= kMatrix)
    return GridMap{{matrix[3], matrix[7]}, {matrix[0], matrix[4]}, {matrix[1], matrix[5]}};
  if (scale.size() >= 2 && ties.size() >= kTie) {
    return GridMap{{ties[3] - ties[0] * scale[0], ties[4] + ties[1] * scale[1]},
                   {scale[0], 0},
                   {0, -scale[1]}};
  }
  if (ties.size() > kTie)
    tiff.fail("has control points in place of a grid; `gdalwarp` makes a grid of it");
  return std::nullopt;
}

/// Takes the grid of the tags, or that of a world file.
void find_grid(images::TiffFile& tiff, storage::FileSystem& files, GeoTiffPlace& place) {
  if (const auto told = told_grid(tiff)) {
    const double half = place.keys.is_point ? 0 : 0.5;
    place.map = *told;
    place.map.first = told->at(half, half);
  } else if (const auto world = read_world_file(files, tiff.file().path())) {
    place.map = world->map;
    place.beside.push_back(world->path);
  } else {
    tiff.fail("does not say where its cells lie; `gdal_translate -a_srs ... -a_ullr ...` does");
  }
}

/// Takes the CRS of a .prj if the keys tell none.
void find_crs(const std::filesystem::path& path, storage::FileSystem& files, GeoTiffPlace& place) {
  if (place.keys.kind != geodesy::MapKind::unknown)
    return;
  auto crs = read_crs_file(files, path);
  if (!crs || crs->keys.kind == geodesy::MapKind::unknown)
    return;
  crs->keys.is_point = place.keys.is_point;
  place.keys = std::move(crs->keys);
  place.beside.push_back(std::move(crs->path));
}

void require_map(const GridMap& map, images::TiffFile& tiff) {
  const auto finite = [](MapPoint p) { return is_coordinate(p.x) && is_coordinate(p.y); };
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

GeoTiffPlace read_place(images::TiffFile& tiff, storage::FileSystem& files) {
  GeoTiffPlace place;
  place.keys = geo_keys_of(tiff);
  find_grid(tiff, files, place);
  find_crs(tiff.file().path(), files, place);
  require_map(place.map, tiff);
  return place;
}

std::vector<std::filesystem::path> place_files_of(const storage::File& file) {
  images::TiffFile tiff(file, images::kMostTiffHead);
  const auto all = images::tiff_directories(tiff);
  std::vector<std::filesystem::path> names;
  const images::TiffDirectory* const image = images::full_image(all);
  if (image == nullptr)
    return names;
  tiff.select(image->offset);
  if (!told_grid(tiff))
    names = world_files_of(file.path());
  if (geo_keys_of(tiff).kind == geodesy::MapKind::unknown)
    names.push_back(crs_file_of(file.path()));
  return names;
}

}  // namespace meshhier::mesh_io
