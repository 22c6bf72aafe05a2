// From cells of a grid to points of a mesh: in a map as it is, or in a frame on the globe.
//
// Lengths. x is easting, y northing, z the height, all in metres.
// Degrees. The frame stands at the middle of the grid, on the ellipsoid of WGS 84: x points east, y
// north, z up. The earth's curvature is in it: far from the middle the ground falls away.
// Degrees on a map. Where it is asked for, x and y are those of another map (cell_places.h), z is
// the height as it is.
//
//                     z  y                 p = R (geocentric(longitude, latitude, height) - middle)
//                  . -+-'--- .
//             . '     '--> x     ' .       by arithmetic that is the same on every processor; the
//           '                       '      turns of columns and of a row are found once each
#pragma once

#include "base/angle.h"
#include "base/vec.h"
#include "mesh_io/cell_places.h"
#include "mesh_io/mosaic.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// Where the frame of a grid in degrees stands: degrees, height 0.
struct GlobePlace {
  double longitude = 0, latitude = 0;
};

/// Returns a place rounded to 2^-20 degrees (0.1 m), its longitude from -180 to 180.
GlobePlace rounded(GlobePlace place);
/// Returns the middle of a grid in degrees, rounded; nothing of others.
std::optional<GlobePlace> middle_of(const Mosaic& mosaic);

/// Thread-safe.
class TerrainFrame {
 public:
  /// `map`: the places of cells on another map, in metres; null: the grid's own, or its frame.
  explicit TerrainFrame(const Mosaic& mosaic, std::shared_ptr<const CellPlaces> map = nullptr);

  /// Returns whether triangles (cell, cell below, cell right of that) face down: rows go north.
  bool is_mirrored() const { return is_mirrored_; }
  /// Returns whether all points of cells are different, by their columns and rows alone.
  bool keeps_apart() const { return !middle_ && other_map_ == nullptr; }
  /// Returns the memory of its tables.
  std::uint64_t held_bytes() const {
    return turns_.size() * sizeof(UnitTurn) + (other_map_ ? other_map_->held_bytes() : 0);
  }

  /// Returns the points of the cells of a row that have a height, one after another. `points` is
  /// used again.
  void place(std::uint32_t row, std::uint32_t first, std::span<const double> heights,
             std::vector<Vec3d>& points) const;

 private:
  void place_on_map(std::uint32_t row, std::uint32_t first, std::span<const double> heights,
                    std::vector<Vec3d>& points) const;
  Vec3d on_globe(UnitTurn longitude, UnitTurn latitude, double height) const;
  UnitTurn turn_of(double degrees) const;

  GridMap map_;
  double unit_ = 1;
  bool is_mirrored_ = false;
  std::shared_ptr<const CellPlaces> other_map_;
  std::optional<GlobePlace> middle_;  ///< of the frame, if there is one
  UnitTurn latitude_;                 ///< the middle's
  Vec3d base_;                        ///< geocentric, with the middle's longitude as 0
  bool is_upright_ = false;           ///< columns are meridians, rows are parallels
  std::vector<UnitTurn> turns_;       ///< of the columns, from the middle's longitude on, if so
};

}  // namespace meshhier::mesh_io
