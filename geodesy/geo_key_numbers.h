// The numbers of GeoTIFF's keys (OGC 19-008r4, annex B), and of values that several have.
#pragma once

#include <cstdint>

namespace meshhier::geodesy {

enum GeoKey : std::uint16_t {
  kModelType = 1024,
  kRasterType = 1025,
  kCitation = 1026,
  kGeodeticCrs = 2048,
  kDatum = 2050,
  kAngularUnit = 2054,
  kAngularUnitSize = 2055,
  kOwnEllipsoid = 2056,
  kSemiMajorAxis = 2057,
  kInverseFlattening = 2059,
  kProjectedCrs = 3072,
  kProjectedCitation = 3073,
  kProjection = 3074,
  kProjectionMethod = 3075,
  kLinearUnit = 3076,
  kLinearUnitSize = 3077,
  kVerticalCrs = 4096,
  kVerticalUnit = 4099
};

/// The tags that hold the keys' values.
inline constexpr std::uint16_t kGeoDoublesTag = 34736, kGeoTextTag = 34737;
/// The value of a key that is defined by others.
inline constexpr std::uint16_t kUserDefined = 32767;

}  // namespace meshhier::geodesy
