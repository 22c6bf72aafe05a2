#include "mesh_io/mosaic.h"

#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// The most columns: a row of heights of a thread takes 32 MB.
constexpr std::int64_t kMostColumns = std::int64_t{1} << 22;
/// Runs of a row have counts (import/terrain_cells.h).
constexpr std::int64_t kMostRows = std::int64_t{1} << 24;

/// How far apart places of two grids may lie to be one, in cells: files round steps and corners.
constexpr double kSamePlace = 1e-2;

constexpr const char* kRegrid = "; `gdalwarp -tr ... -tap` brings them to one grid";
constexpr const char* kOneMap =
    "; `gdalwarp -t_srs` brings it to another CRS, `gdal_edit.py -a_srs` names one that is missing";

std::unique_ptr<HeightRaster> open_height_raster(storage::FileSystem& files,
                                                 const std::filesystem::path& path) {
  const MeshFormat format = detect_format(*files.open(path));
  switch (format.kind) {
    case MeshKind::geotiff:
      return open_geotiff(files, path);
    case MeshKind::hgt:
      return open_hgt(files, path);
    default:
      return open_asc(files, path);
  }
}

/// Returns the column and row of a place of the map.
MapPoint cell_at(const GridMap& map, MapPoint place) {
  const double x = place.x - map.first.x, y = place.y - map.first.y;
  const double area = map.determinant();
  return {(x * map.row.y - y * map.row.x) / area, (y * map.column.x - x * map.column.y) / area};
}

double way_length(MapPoint way) {
  return std::sqrt(way.x * way.x + way.y * way.y);
}

double nearest(double value) {
  return std::floor(value + 0.5);
}

[[noreturn]] void fail_apart(const RasterHead& head, const RasterHead& first,
                             const std::string& how, const char* remedy = kRegrid) {
  fail_file(head.path,
            fmt::format("cannot be joined with {}: {}{}", first.path.string(), how, remedy));
}

/// Throws unless the steps of two grids are the same over all of the second one.
void require_same_steps(const RasterHead& head, const RasterHead& first) {
  const MapPoint begin = cell_at(first.map, head.map.first);
  const double columns = head.columns, rows = head.rows;
  for (const MapPoint corner : {MapPoint{columns, 0}, MapPoint{0, rows}}) {
    const MapPoint cell = cell_at(first.map, head.map.at(corner.x, corner.y));
    if (!(std::abs(cell.x - begin.x - corner.x) <= kSamePlace) ||
        !(std::abs(cell.y - begin.y - corner.y) <= kSamePlace)) {
      fail_apart(head, first,
                 fmt::format("its cells are {} x {} of the map, the others {} x {}",
                             way_length(head.map.column), way_length(head.map.row),
                             way_length(first.map.column), way_length(first.map.row)));
    }
  }
}

void require_same_map(const RasterHead& head, const RasterHead& first) {
  const auto name = [](const geodesy::RasterMap& keys) {
    return keys.crs.empty() ? std::string("no known CRS") : keys.crs;
  };
  if (head.keys.crs != first.keys.crs || head.keys.kind != first.keys.kind ||
      head.keys.unit != first.keys.unit) {
    fail_apart(head, first,
               fmt::format("it lies in {}, the other in {}", name(head.keys), name(first.keys)),
               kOneMap);
  }
}

}  // namespace

SharedCells& SharedCells::operator+=(const SharedCells& other) {
  equal += other.equal;
  different += other.different;
  most = std::max(most, other.most);
  return *this;
}

Mosaic::Mosaic(storage::FileSystem& files, const std::vector<std::filesystem::path>& paths) {
  for (const std::filesystem::path& path : paths)
    add(open_height_raster(files, path));
  settle();
}

void Mosaic::add(std::unique_ptr<HeightRaster> raster) {
  const RasterHead& head = raster->head();
  if (std::uint64_t{head.columns} * head.rows > std::numeric_limits<std::uint32_t>::max()) {
    fail_file(head.path, fmt::format("has {} x {} cells, 2^32 or more; build parts of it "
                                     "(`gdal_translate -srcwin` cuts them out)",
                                     head.columns, head.rows));
  }
  MapPoint cell;
  if (!parts_.empty()) {
    const RasterHead& first = parts_[0].raster->head();
    require_same_map(head, first);
    require_same_steps(head, first);
    const MapPoint begin = cell_at(first.map, head.map.first);
    cell = {nearest(begin.x), nearest(begin.y)};
    const double aside = std::max(std::abs(begin.x - cell.x), std::abs(begin.y - cell.y));
    if (!(aside <= kSamePlace))
      fail_apart(head, first, fmt::format("its cells lie {:.3g} of a cell beside the grid", aside));
    if (!(std::abs(cell.x) < 0x1p31) || !(std::abs(cell.y) < 0x1p31))
      fail_apart(head, first, "they lie too far apart");
  }
  may_have_voids_ = may_have_voids_ || head.may_have_voids;
  parts_.push_back(
      {std::move(raster), static_cast<std::int64_t>(cell.x), static_cast<std::int64_t>(cell.y)});
}

/// Makes the grid that has all rasters.
void Mosaic::settle() {
  std::int64_t left = 0, top = 0, right = 0, bottom = 0;
  for (const Part& part : parts_) {
    left = std::min(left, part.column);
    top = std::min(top, part.row);
    right = std::max(right, part.column + part.raster->head().columns);
    bottom = std::max(bottom, part.row + part.raster->head().rows);
  }
  if (right - left > kMostColumns || bottom - top > kMostRows) {
    fail_file(parts_[0].raster->head().path,
              fmt::format("the grid has {} columns and {} rows, more than {} and {}; build parts "
                          "of it",
                          right - left, bottom - top, kMostColumns, kMostRows));
  }
  for (Part& part : parts_) {
    part.column -= left;
    part.row -= top;
  }
  const RasterHead& named = parts_[0].raster->head();
  map_ = named.map;
  map_.first = map_.at(static_cast<double>(left), static_cast<double>(top));
  columns_ = static_cast<std::uint32_t>(right - left);
  rows_ = static_cast<std::uint32_t>(bottom - top);
  may_have_voids_ = may_have_voids_ || columns_ != named.columns || rows_ != named.rows;
  require_latitudes(named.path);
  blocks_ = std::make_unique<DecodedBlocks>(held_bytes());
}

void Mosaic::require_latitudes(const std::filesystem::path& path) const {
  constexpr double kPole = 90, kBeyond = 1e-6;
  const double right = columns_ - 1.0, bottom = rows_ - 1.0;
  for (const MapPoint cell : {MapPoint{0, 0}, {right, 0}, {0, bottom}, {right, bottom}}) {
    const double latitude = map_.at(cell.x, cell.y).y * keys().unit;
    if (keys().kind == geodesy::MapKind::degrees && !(std::abs(latitude) <= kPole + kBeyond)) {
      fail_file(path, fmt::format("is told to lie in degrees, but reaches to the latitude {}: is "
                                  "its CRS another one? `gdal_translate -a_srs` says so",
                                  latitude));
    }
  }
}

std::vector<std::string> Mosaic::warnings() const {
  std::vector<std::string> all;
  for (const Part& part : parts_) {
    const auto& one = part.raster->head().warnings;
    all.insert(all.end(), one.begin(), one.end());
  }
  if (keys().crs.empty() && keys().kind != geodesy::MapKind::degrees) {
    all.push_back(file_message(
        parts_[0].raster->head().path,
        keys().is_user_defined
            ? "defines its CRS by parameters, which are not read: without \"placement.crs\" the "
              "surface has no place on the globe"
            : "does not say in which CRS it lies: without \"placement.crs\" the surface has no "
              "place on the globe"));
  }
  return all;
}

/// The blocks of two rows of blocks, of all rasters side by side; and what threads that read other
/// rows hold, if blocks are small.
std::uint64_t Mosaic::held_bytes() const {
  constexpr std::uint64_t kBeside = std::uint64_t{16} << 20;
  std::uint64_t most = 0;
  for (const Part& part : parts_) {
    std::uint64_t bytes = 0;
    for (const Part& other : parts_) {
      const bool has_row =
          part.row >= other.row && part.row <= other.row + other.raster->head().rows;
      bytes += has_row ? 2 * other.raster->row_bytes() : 0;
    }
    most = std::max(most, bytes);
  }
  return most + kBeside;
}

void Mosaic::read(std::uint32_t row, std::uint32_t first, std::span<double> heights,
                  SharedCells* shared) const {
  std::ranges::fill(heights, std::numeric_limits<double>::quiet_NaN());
  bool is_first = true;
  for (const Part& part : parts_) {
    const RasterHead& head = part.raster->head();
    const std::int64_t begin = std::max<std::int64_t>(first, part.column);
    const std::int64_t end = std::min<std::int64_t>(
        first + static_cast<std::int64_t>(heights.size()), part.column + head.columns);
    if (row < part.row || row >= part.row + head.rows || begin >= end)
      continue;
    const auto to = heights.subspan(static_cast<std::size_t>(begin - first),
                                    static_cast<std::size_t>(end - begin));
    const Cells cells{static_cast<std::uint32_t>(row - part.row),
                      static_cast<std::uint32_t>(begin - part.column)};
    if (std::exchange(is_first, false))
      part.raster->read(*blocks_, cells.row, cells.column, to);
    else
      add_to(to, part, cells, shared);
  }
}

/// Fills the cells that have no height yet from another raster.
void Mosaic::add_to(std::span<double> heights, const Part& part, const Cells& cells,
                    SharedCells* shared) const {
  std::vector<double> more(heights.size());
  part.raster->read(*blocks_, cells.row, cells.column, more);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (std::isnan(heights[i])) {
      heights[i] = more[i];
    } else if (shared != nullptr && !std::isnan(more[i])) {
      ++(heights[i] == more[i] ? shared->equal : shared->different);
      shared->most = std::max(shared->most, std::abs(heights[i] - more[i]));
    }
  }
}

}  // namespace meshhier::mesh_io
