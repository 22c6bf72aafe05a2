// The map, or the plane, on which a hierarchy is seen from above.
//
// Idea. From above is what stands in z: on a map its heights; on the globe what points away from
// the ellipsoid, where the middle of the model is; else the input's up axis. All of it is one
// affine map of positions, in which axes that stay stay exactly, and on the globe a small term for
// the heights: a plane leaves the ellipsoid by d^2 / 2 r at a distance d.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "geodesy/geo_keys.h"
#include "storage/format/manifest.h"

#include <array>
#include <string>

namespace meshhier::exporting {

/// Immutable, thread-safe.
struct MapFrame {
  std::array<Vec3d, 3> rows{};  ///< east, north and height of a unit along each of the input's axes
  Vec3d shift{};                ///< of the input's point 0
  Vec3d origin{};               ///< of the hierarchy's positions, in the input's coordinates
  double curve_east = 0, curve_north = 0;  ///< what squares of distances add to a height

  geodesy::GeoKeys picture_keys{}, height_keys{};
  std::string name{};  ///< for people: "EPSG:25832 (ETRS89 / UTM zone 32N)"; empty: no map
  bool is_on_globe = false;

  /// Returns east, north and height of a place of the input. Of a float that was an input's
  /// coordinate, and whose axis stays, the same number.
  Vec3d of_input(Vec3d p) const {
    const Vec3d flat{dot(rows[0], p) + shift.x, dot(rows[1], p) + shift.y,
                     dot(rows[2], p) + shift.z};
    return {flat.x, flat.y, flat.z + curve_east * flat.x * flat.x + curve_north * flat.y * flat.y};
  }
  /// The same of a position of the hierarchy.
  Vec3d operator()(Vec3f position) const { return of_input(to_double(position) + origin); }
  /// Returns the box around the corners of a box of the hierarchy.
  BoundsD around(const BoundsD& box) const;
  /// Returns how long a unit of the input is.
  double scale() const { return length(Vec3d{rows[0].x, rows[1].x, rows[2].x}); }
};

/// Returns the frame of a hierarchy: of its CRS, of its place on the globe, or of its input. Throws
/// as config::mapped_model().
MapFrame map_frame(const storage::Manifest& manifest);

}  // namespace meshhier::exporting
