#include "import/terrain_drape.h"

#include "base/error.h"
#include "geodesy/map_change.h"
#include "images/tiff_picture.h"
#include "images/tiff_pixels.h"
#include "import/terrain_map.h"
#include "mesh_io/geotiff_place.h"
#include "mesh_io/input_error.h"
#include "mesh_io/part_of_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using geodesy::MapKind;
using geodesy::RasterMap;
using mesh_io::GridMap;
using mesh_io::MapPoint;

/// Pixels. Texture coordinates are floats: those of a side of 65,536 pixels are 2^-8 of one apart.
constexpr double kPixelGrain = 0x1p-11, kPixelTolerance = 0x1p-7;
/// What is told, in pixels.
constexpr double kMostPixelError = 0.25;

/// Returns whether two rasters lie in one map, as far as they tell.
bool is_one_map(const RasterMap& a, const RasterMap& b) {
  if (!a.crs.empty() && !b.crs.empty())
    return geodesy::horizontal_code(a.crs) == geodesy::horizontal_code(b.crs);
  return a.kind == MapKind::unknown || b.kind == MapKind::unknown ||
         (a.kind == b.kind && a.unit == b.unit);
}

/// The size of the picture with its frame, and how its pixels lie.
struct PictureGrid {
  double width = 0, height = 0;
  GridMap map;
  GridMap to_pixels;  ///< from differences to the first pixel's place
  RasterMap keys;

  double longest() const { return std::max(width, height); }
  /// Returns the texture coordinates of a pixel.
  MapPoint texcoord(MapPoint pixel) const {
    constexpr double kToCorner = images::kPictureFrame + 0.5;
    return {(pixel.x + kToCorner) / width, (pixel.y + kToCorner) / height};
  }
  /// Returns those of a place of its map.
  MapPoint at(MapPoint place) const {
    return texcoord(to_pixels.at(place.x - map.first.x, place.y - map.first.y));
  }
  /// Returns the width of the globe in units of the map; 0 if it has none.
  double turn() const {
    constexpr double kRound = 360;
    return keys.kind == MapKind::degrees ? kRound / keys.unit : 0;
  }
  MapPoint middle() const { return map.at(width / 2, height / 2); }
};

/// Returns the columns and rows of differences to the first place of a map: its inverse.
GridMap inverse(const GridMap& map) {
  const double area = map.determinant();
  return {{}, {map.row.y / area, -map.column.y / area}, {-map.row.x / area, map.column.x / area}};
}

/// Returns `x`, whole turns away, so that it is the nearest to another one.
double nearest_turn(double x, double to, double turn) {
  return turn > 0 ? x + turn * std::floor((to - x) / turn + 0.5) : x;
}

MapPoint middle_cell(const mesh_io::Mosaic& heights) {
  return {(heights.columns() - 1.0) / 2, (heights.rows() - 1.0) / 2};
}

/// Returns the map from cells to texture coordinates: first one map, then the inverse of the other.
/// Differences of places are taken before they are divided: places have many digits.
GridMap within_map(const mesh_io::Mosaic& heights, const PictureGrid& picture) {
  const GridMap& cells = heights.map();
  const MapPoint cell = middle_cell(heights);
  const double middle = cells.at(cell.x, cell.y).x;
  const double turned = nearest_turn(middle, picture.middle().x, picture.turn()) - middle;
  const auto along = [&](MapPoint way) { return picture.to_pixels.at(way.x, way.y); };
  const MapPoint column = along(cells.column), row = along(cells.row);
  return {picture.at({cells.first.x + turned, cells.first.y}),
          {column.x / picture.width, column.y / picture.height},
          {row.x / picture.width, row.y / picture.height}};
}

/// Returns the CRS of heights; `crs`: the one that the config says, which lengths lie in.
std::string crs_of(const RasterMap& heights, const std::string& crs) {
  if (heights.kind == MapKind::degrees)
    return heights.crs.empty() ? kPlainDegrees : heights.crs;
  return crs.empty() ? heights.crs : crs;
}

/// Throws that a raster needs a CRS because the other one has such a map.
[[noreturn]] void fail_without_crs(const std::filesystem::path& path, const RasterMap& keys,
                                   const std::filesystem::path& other, const RasterMap& others) {
  mesh_io::fail_file(
      path,
      fmt::format("{}, while {} lies in {}; `gdal_edit.py -a_srs` names a CRS",
                  keys.is_user_defined ? "defines its CRS by parameters, which are not read"
                                       : "does not say in which CRS it lies",
                  other.string(),
                  !others.crs.empty()               ? others.crs
                  : others.kind == MapKind::degrees ? std::string("degrees")
                                                    : fmt::format("units of {} m", others.unit)));
}

/// The way from cells to the picture, which lies on another map.
class OtherMap {
 public:
  OtherMap(const mesh_io::Mosaic& heights, const PictureGrid& picture, const std::string& from)
      : cells_(heights.map()), picture_(picture), change_(from, picture.keys.crs) {
    const MapPoint cell = middle_cell(heights);
    const MapPoint middle = cells_.at(cell.x, cell.y);
    change_.settle_at({middle.x, middle.y, 0});
    const auto there = change_.find({middle.x, middle.y, 0});
    middle_ = nearest_turn(there ? there->x : 0, picture.middle().x, picture.turn());
  }

  mesh_io::CellPlaces::Change change() const {
    constexpr double kAround = 0.01;  // of the picture
    const double finest = std::bit_ceil(static_cast<std::uint32_t>(picture_.longest()));
    return {.exact = [this](MapPoint cell) { return texcoord(cell); },
            .grain = kPixelGrain / finest,
            .tolerance = kPixelTolerance / finest,
            .least = {-kAround, -kAround},
            .most = {1 + kAround, 1 + kAround}};
  }

  bool takes_datums_as_one() const { return change_.takes_datums_as_one(); }

 private:
  MapPoint texcoord(MapPoint cell) const {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const MapPoint at = cells_.at(cell.x, cell.y);
    const auto there = change_.find({at.x, at.y, 0});
    if (!there)
      return {kNone, kNone};
    return picture_.at({nearest_turn(there->x, middle_, picture_.turn()), there->y});
  }

  const GridMap& cells_;
  const PictureGrid& picture_;
  geodesy::MapChange change_;
  double middle_ = 0;  ///< the longitude of the heights' middle
};

/// Whether all corners and the middle of the heights lie beyond one edge of the picture.
bool lies_beside(const mesh_io::CellPlaces& texcoords, const mesh_io::Mosaic& heights) {
  const double right = heights.columns() - 1.0, bottom = heights.rows() - 1.0;
  const std::array places{texcoords.at(0, 0), texcoords.at(right, 0), texcoords.at(0, bottom),
                          texcoords.at(right, bottom), texcoords.at(right / 2, bottom / 2)};
  const auto all = [&](const auto& is_beyond) { return std::ranges::all_of(places, is_beyond); };
  return all([](MapPoint at) { return at.x < 0; }) || all([](MapPoint at) { return at.x > 1; }) ||
         all([](MapPoint at) { return at.y < 0; }) || all([](MapPoint at) { return at.y > 1; });
}

PictureGrid picture_grid(const images::ImageInfo& head, mesh_io::GeoTiffPlace place) {
  return {.width = static_cast<double>(head.width),
          .height = static_cast<double>(head.height),
          .map = place.map,
          .to_pixels = inverse(place.map),
          .keys = std::move(place.keys)};
}

/// Finds texture coordinates by PROJ.
void drape_by_proj(const std::filesystem::path& path, const mesh_io::Mosaic& heights,
                   const PictureGrid& picture, const std::string& from, TerrainDrape& drape) {
  const OtherMap way(heights, picture, from);
  drape.texcoords =
      std::make_shared<const mesh_io::CellPlaces>(heights.columns(), heights.rows(), way.change());
  const auto warn = [&](const std::string& text) {
    drape.warnings.push_back(mesh_io::file_message(path, text));
  };
  const double error = drape.texcoords->largest_error() * picture.longest();
  if (!std::isfinite(error)) {
    mesh_io::fail_file(path, fmt::format("{} has no map of the heights around it; `gdalwarp -t_srs "
                                         "{}` brings it to theirs",
                                         picture.keys.crs, geodesy::horizontal_code(from)));
  }
  if (error > kMostPixelError)
    warn(fmt::format("may lie up to {:.1f} pixels off: its map is too uneven over the heights",
                     error));
  if (way.takes_datums_as_one()) {
    warn(
        fmt::format("PROJ does not know the way from the datum of {} to that of {}, and takes "
                    "them as one",
                    from, picture.keys.crs));
  }
}

/// Returns the map of heights, with the CRS that the config says if they have none.
RasterMap map_of(const mesh_io::Mosaic& heights, const std::string& crs) {
  RasterMap own = heights.keys();
  if (own.crs.empty() && own.kind != MapKind::degrees)
    own.crs = crs;
  return own;
}

/// Finds texture coordinates. `path`: the picture's.
void lay(const std::filesystem::path& path, const PictureGrid& picture,
         const mesh_io::Mosaic& heights, const std::string& crs, TerrainDrape& drape) {
  const RasterMap own = map_of(heights, crs);
  const std::string from = crs_of(own, crs);
  if (!is_one_map(picture.keys, own)) {
    if (picture.keys.crs.empty())
      fail_without_crs(path, picture.keys, heights.path(), own);
    if (from.empty())
      fail_without_crs(heights.path(), own, path, picture.keys);
    return drape_by_proj(path, heights, picture, from, drape);
  }
  drape.texcoords = std::make_shared<const mesh_io::CellPlaces>(within_map(heights, picture));
  const bool is_bare = picture.keys.kind == MapKind::unknown;
  const bool are_bare = own.kind == MapKind::unknown && own.crs.empty();
  if (lies_beside(*drape.texcoords, heights)) {
    if (is_bare && !are_bare)
      fail_without_crs(path, picture.keys, heights.path(), own);
    if (are_bare && !is_bare)
      fail_without_crs(heights.path(), own, path, picture.keys);
  } else if (is_bare && !are_bare) {
    drape.warnings.push_back(mesh_io::file_message(
        path, "does not say in which CRS it lies: it is taken to lie in that of the heights"));
  }
}

images::MaterialList material_of(const std::filesystem::path& path) {
  images::Material material;
  material.name = "orthophoto";
  material.image = 0;
  material.wrap_u = material.wrap_v = Wrap::clamp;
  images::MaterialList list;
  list.materials.push_back(std::move(material));
  list.images.push_back({.name = path.filename().string(), .file = path, .is_drape = true});
  return list;
}

}  // namespace

TerrainDrape open_drape(storage::FileSystem& files, const std::filesystem::path& path,
                        const mesh_io::Mosaic& heights, const std::string& crs) {
  const std::shared_ptr<const storage::File> file = files.open(path);
  const auto head =
      images::open_framed_tiff(mesh_io::part_of(file, 0, file->size()), path.string())->info();
  images::TiffFile tiff(*file, images::kMostTiffHead);
  const auto all = images::tiff_directories(tiff);
  tiff.select(images::full_image(all)->offset);  // the picture above has one
  mesh_io::GeoTiffPlace place = mesh_io::read_place(tiff, files);
  TerrainDrape drape{.materials = material_of(path), .beside = std::move(place.beside)};
  lay(path, picture_grid(head, std::move(place)), heights, crs, drape);
  if (lies_beside(*drape.texcoords, heights)) {
    drape.warnings.push_back(
        mesh_io::file_message(path, "lies beside the heights: nothing of them shows it"));
  }
  return drape;
}

}  // namespace meshhier::importing
