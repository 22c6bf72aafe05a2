// The ellipsoid of WGS 84, by arithmetic whose result IEEE 754 fixes.
#pragma once

#include "base/angle.h"
#include "base/vec.h"

#include <cmath>

namespace meshhier::wgs84 {

inline constexpr double kEquator = 6378137;  ///< semi-axes, metres
inline constexpr double kPole = 6356752.3142451793;
inline constexpr double kFlattening = 1 / 298.257223563;
inline constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);

/// Away from the ellipsoid.
inline Vec3d up_at(UnitTurn longitude, UnitTurn latitude) {
  return {latitude.cosine * longitude.cosine, latitude.cosine * longitude.sine, latitude.sine};
}

/// EPSG:4978. `height`: above the ellipsoid, metres.
inline Vec3d geocentric(UnitTurn longitude, UnitTurn latitude, double height) {
  const double normal = kEquator / std::sqrt(1 - kEccentricity2 * latitude.sine * latitude.sine);
  const Vec3d up = up_at(longitude, latitude);
  return {(normal + height) * up.x, (normal + height) * up.y,
          (normal * (1 - kEccentricity2) + height) * up.z};
}

}  // namespace meshhier::wgs84
