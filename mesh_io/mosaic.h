// Rasters that lie on one grid, as one.
//
//      a . . . .                     The grid of the first raster goes on over all others. Where
//      . . . b b b b                 two have a cell, the first one that has a height there counts;
//      . . . b b b b                 cells between neighbours are ordinary cells of the grid.
#pragma once

#include "mesh_io/height_raster.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// Cells that several rasters have.
struct SharedCells {
  std::uint64_t equal = 0;
  std::uint64_t different = 0;  ///< by their heights
  double most = 0;              ///< the largest difference, metres

  SharedCells& operator+=(const SharedCells& other);
};

/// Thread-safe.
class Mosaic {
 public:
  /// Opens the rasters. Throws as open_geotiff() and the like; Error(input) if they do not lie on
  /// one grid of one map, or if there are too many columns or rows. Requires a path.
  Mosaic(storage::FileSystem& files, const std::vector<std::filesystem::path>& paths);

  std::uint32_t columns() const { return columns_; }
  std::uint32_t rows() const { return rows_; }
  const GridMap& map() const { return map_; }
  const geodesy::RasterMap& keys() const { return parts_[0].raster->head().keys; }
  /// Returns the first raster's.
  const std::filesystem::path& path() const { return parts_[0].raster->head().path; }
  /// Returns whether there may be cells without a height.
  bool may_have_voids() const { return may_have_voids_; }
  std::uint64_t cells() const { return std::uint64_t{columns_} * rows_; }
  /// Returns whether points of its mesh are in metres: not if nobody knows the map's unit.
  bool is_in_metres() const { return keys().kind != geodesy::MapKind::unknown; }
  /// Returns the warnings of all rasters, a line each.
  std::vector<std::string> warnings() const;
  /// Returns the memory that it may hold.
  std::uint64_t held_bytes() const;

  /// Lets go of what was read lately. No thread may read meanwhile.
  void release() const { blocks_->clear(); }

  /// Reads heights as HeightRaster::read(); adds to `shared` what several rasters have, if it is
  /// not null.
  void read(std::uint32_t row, std::uint32_t first, std::span<double> heights,
            SharedCells* shared = nullptr) const;

 private:
  struct Part {
    std::unique_ptr<HeightRaster> raster;
    std::int64_t column = 0, row = 0;  ///< its first cell in the grid
  };

  /// The first of some cells of a raster.
  struct Cells {
    std::uint32_t row = 0, column = 0;
  };

  void add(std::unique_ptr<HeightRaster> raster);
  void settle();
  void require_latitudes(const std::filesystem::path& path) const;
  void add_to(std::span<double> heights, const Part& part, const Cells& cells,
              SharedCells* shared) const;

  std::vector<Part> parts_;
  GridMap map_;
  std::uint32_t columns_ = 0, rows_ = 0;
  bool may_have_voids_ = false;
  std::unique_ptr<DecodedBlocks> blocks_;
};

}  // namespace meshhier::mesh_io
