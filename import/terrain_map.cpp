#include "import/terrain_map.h"

#include "base/error.h"
#include "geodesy/map_change.h"
#include "geodesy/map_projection.h"
#include "mesh_io/input_error.h"

#include <limits>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

// Metres. Places of maps are rounded so elsewhere, too (geodesy/map_transform.h).
constexpr double kMapGrain = 0x1p-13, kMapTolerance = 0x1p-10;
/// A map that is farther off is torn there.
constexpr double kMostMapError = 1;

/// Returns the way of a grid's cells to places in metres. `change`: to a map with such a unit.
mesh_io::CellPlaces::Change change_of(const mesh_io::GridMap& grid,
                                      const geodesy::MapChange& change, double unit) {
  constexpr double kFar = std::numeric_limits<double>::max();
  return {.exact = [&grid, &change, unit](mesh_io::MapPoint cell) -> mesh_io::MapPoint {
            const mesh_io::MapPoint at = grid.at(cell.x, cell.y);
            const Vec3d there = change({at.x, at.y, 0});
            return {there.x * unit, there.y * unit};
          },
          .grain = kMapGrain,
          .tolerance = kMapTolerance,
          .least = {-kFar, -kFar},
          .most = {kFar, kFar}};
}

double unit_of(const std::string& crs) {
  const geodesy::MapProjection map(crs);
  if (map.heights().empty())
    throw Error(ErrorCode::usage, crs + " is geocentric, and no map that heights stand on");
  return map.unit_metres();
}

TerrainMap made_map(const mesh_io::Mosaic& mosaic, const std::string& crs) {
  const std::string& own = mosaic.keys().crs;
  const mesh_io::GridMap& grid = mosaic.map();
  const double unit = unit_of(crs);
  geodesy::MapChange change(own.empty() ? kPlainDegrees : own, crs);
  const mesh_io::MapPoint middle = grid.at((mosaic.columns() - 1.0) / 2, (mosaic.rows() - 1.0) / 2);
  change.settle_at({middle.x, middle.y, 0});
  TerrainMap made;
  made.places = std::make_shared<const mesh_io::CellPlaces>(mosaic.columns(), mosaic.rows(),
                                                            change_of(grid, change, unit));
  const double error = made.places->largest_error();
  if (!(error <= kMostMapError)) {
    throw Error(ErrorCode::usage,
                "the heights reach over an edge of the map, where their places jump");
  }
  if (error > kMapTolerance)
    made.warnings.push_back(fmt::format("places on {} may be {:.3g} m off", crs, error));
  if (change.takes_datums_as_one()) {
    made.warnings.push_back(fmt::format(
        "PROJ does not know the way from the datum of {} to that of {}, and takes them as one",
        own.empty() ? kPlainDegrees : own, crs));
  }
  return made;
}

}  // namespace

TerrainMap bring_to_map(const mesh_io::Mosaic& mosaic, const std::string& crs) {
  try {
    return made_map(mosaic, crs);
  } catch (const Error& error) {
    throw error.within("placement.crs");
  }
}

}  // namespace meshhier::importing
