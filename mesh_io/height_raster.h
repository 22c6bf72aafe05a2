// A file of heights in rows and columns, and which place of a map each of them stands at.
#pragma once

#include "geodesy/raster_map.h"
#include "mesh_io/decoded_blocks.h"
#include "mesh_io/formats.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// A place of a map, in its units: easting and northing, or longitude and latitude.
struct MapPoint {
  double x = 0, y = 0;
  friend bool operator==(const MapPoint&, const MapPoint&) = default;
};

/// The affine map from columns and rows to places of a map.
struct GridMap {
  MapPoint first;        ///< the middle of the first cell of the first row
  MapPoint column, row;  ///< the way to the next column, and to the next row

  MapPoint at(double c, double r) const {
    return {first.x + c * column.x + r * row.x, first.y + c * column.y + r * row.y};
  }
  double determinant() const { return column.x * row.y - column.y * row.x; }
};

/// The facts of a file before its heights are read.
struct RasterHead {
  std::filesystem::path path;
  std::uint32_t columns = 0, rows = 0;
  GridMap map{};
  geodesy::RasterMap keys{};
  bool may_have_voids = false;          ///< cells without a height
  std::vector<std::string> warnings{};  ///< a line each
};

class HeightRaster {
 public:
  virtual ~HeightRaster() = default;
  virtual const RasterHead& head() const = 0;
  /// Reads heights of row `row` from column `first` on, in metres if the file tells their unit;
  /// NaN: the cell has none. `blocks` must not outlive the raster. Thread-safe. Throws Error(input)
  /// naming the file if it is broken, or if a height is no coordinate; Error(io).
  virtual void read(DecodedBlocks& blocks, std::uint32_t row, std::uint32_t first,
                    std::span<double> heights) const = 0;
  /// Returns the bytes of the decoded blocks that a row lies in.
  virtual std::uint64_t row_bytes() const = 0;
};

/// Opens a raster of a kind that has heights; reads its head. Throws Error(input) naming the file,
/// with what to do, if it is broken, has no heights or no place; Error(io).
std::unique_ptr<HeightRaster> open_geotiff(storage::FileSystem& files,
                                           const std::filesystem::path& path);
std::unique_ptr<HeightRaster> open_hgt(storage::FileSystem& files,
                                       const std::filesystem::path& path);
std::unique_ptr<HeightRaster> open_asc(storage::FileSystem& files,
                                       const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
