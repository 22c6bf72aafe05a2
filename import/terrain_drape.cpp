#include "import/terrain_drape.h"

#include "base/error.h"
#include "images/tiff_picture.h"
#include "images/tiff_pixels.h"
#include "mesh_io/geotiff_place.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// Returns a CRS without its heights: "EPSG:32633" of "EPSG:32633+5773".
std::string horizontal(const std::string& crs) {
  return crs.starts_with("EPSG:") ? crs.substr(0, crs.find('+')) : crs;
}

void require_same_crs(const geodesy::RasterMap& picture, const geodesy::RasterMap& heights,
                      const std::filesystem::path& path) {
  const std::string own = horizontal(picture.crs), other = horizontal(heights.crs);
  if (own.empty() || other.empty()
          ? picture.kind == geodesy::MapKind::unknown ||
                heights.kind == geodesy::MapKind::unknown ||
                (picture.kind == heights.kind && picture.unit == heights.unit)
          : own == other)
    return;
  const auto name = [](const std::string& crs) { return crs.empty() ? "no known CRS" : crs; };
  mesh_io::fail_file(path, fmt::format("lies in {}, the heights in {}; `gdalwarp -t_srs {}` brings "
                                       "it there",
                                       name(own), name(other), name(other)));
}

/// Returns the column and row of a map's grid, as a map of places: the inverse.
mesh_io::GridMap inverse(const mesh_io::GridMap& map) {
  const double area = map.determinant();
  const mesh_io::MapPoint x{map.row.y / area, -map.column.y / area};
  const mesh_io::MapPoint y{-map.row.x / area, map.column.x / area};
  return {{-map.first.x * x.x - map.first.y * y.x, -map.first.x * x.y - map.first.y * y.y}, x, y};
}

/// Returns the map from cells to pixels: first one map, then the inverse of the other. Differences
/// of places are taken before they are divided: places have many digits.
mesh_io::GridMap cells_to_pixels(const mesh_io::GridMap& cells, const mesh_io::GridMap& pixels) {
  mesh_io::GridMap turn = inverse(pixels);
  turn.first = {};
  const auto along = [&](mesh_io::MapPoint way) { return turn.at(way.x, way.y); };
  return {along({cells.first.x - pixels.first.x, cells.first.y - pixels.first.y}),
          along(cells.column), along(cells.row)};
}

/// Whether all corners of the heights lie beyond one edge of the picture.
bool lies_beside(const mesh_io::GridMap& texcoords, const mesh_io::Mosaic& heights) {
  const double right = heights.columns() - 1.0, bottom = heights.rows() - 1.0;
  const std::array corners{texcoords.at(0, 0), texcoords.at(right, 0), texcoords.at(0, bottom),
                           texcoords.at(right, bottom)};
  const auto all = [&](const auto& is_beyond) { return std::ranges::all_of(corners, is_beyond); };
  return all([](mesh_io::MapPoint at) { return at.x < 0; }) ||
         all([](mesh_io::MapPoint at) { return at.x > 1; }) ||
         all([](mesh_io::MapPoint at) { return at.y < 0; }) ||
         all([](mesh_io::MapPoint at) { return at.y > 1; });
}

}  // namespace

TerrainDrape open_drape(storage::FileSystem& files, const std::filesystem::path& path,
                        const mesh_io::Mosaic& heights) {
  const auto head = images::open_framed_tiff(files.open(path), path.string())->info();
  const auto file = files.open(path);
  images::TiffFile tiff(*file, images::kMostTiffHead);
  const auto all = images::tiff_directories(tiff);
  tiff.select(images::full_image(all)->offset);  // the picture above has one
  const mesh_io::GeoTiffPlace place = mesh_io::read_place(tiff, files);
  require_same_crs(place.keys, heights.keys(), path);

  TerrainDrape drape;
  const mesh_io::GridMap pixels = cells_to_pixels(heights.map(), place.map);
  const double width = head.width, height = head.height;
  const double to_corner = images::kPictureFrame + 0.5;
  drape.texcoords = {{(pixels.first.x + to_corner) / width, (pixels.first.y + to_corner) / height},
                     {pixels.column.x / width, pixels.column.y / height},
                     {pixels.row.x / width, pixels.row.y / height}};
  drape.lies_beside = lies_beside(drape.texcoords, heights);
  images::Material material;
  material.name = "orthophoto";
  material.image = 0;
  material.wrap_u = material.wrap_v = Wrap::clamp;
  drape.materials.materials.push_back(std::move(material));
  drape.materials.images.push_back(
      {.name = path.filename().string(), .file = path, .is_drape = true});
  return drape;
}

}  // namespace meshhier::importing
