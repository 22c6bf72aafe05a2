// Coordinates of a map and places on the globe, by PROJ.
//
// PROJ never uses the network here. The last bits of its results depend on its version and on the C
// library; the change of datum that it takes depends on its database and on the grids that are
// installed.
#pragma once

#include "base/vec.h"

#include <memory>
#include <string>
#include <string_view>

namespace meshhier::geodesy {

/// The surface below heights of a CRS without a vertical part.
inline constexpr std::string_view kEllipsoid = "the ellipsoid";

/// A place on or above WGS 84: degrees, degrees, metres above the ellipsoid.
struct Geodetic {
  double longitude = 0;
  double latitude = 0;
  double height = 0;
};

/// A coordinate reference system (CRS) with lengths as coordinates: a projected, a geocentric or a
/// compound one. Coordinates are easting, northing, height where the CRS has them, in that order,
/// in its units. Without a vertical part heights are above the ellipsoid of WGS 84, in the unit of
/// easting and northing.
///
/// An object is for one thread at a time.
class MapProjection {
 public:
  /// `crs`: a text that PROJ takes: "EPSG:25832", "EPSG:32633+5773", WKT, a PROJ string; it must
  /// not name files by a path. Throws Error(usage) saying what is wrong with it, Error(io) if
  /// PROJ's database is not there.
  explicit MapProjection(const std::string& crs);
  ~MapProjection();
  MapProjection(MapProjection&&) noexcept;
  MapProjection& operator=(MapProjection&&) noexcept;

  /// Settles on the change of datum for the place of these coordinates: all other places follow it,
  /// so that nothing jumps. Throws as to_geocentric().
  void settle_at(Vec3d map);

  /// Returns geocentric coordinates (WGS 84, EPSG:4978), metres. Throws Error(usage) if there are
  /// none.
  Vec3d to_geocentric(Vec3d map) const;
  /// Converts geocentric coordinates by PROJ, for people.
  Geodetic to_geodetic(Vec3d geocentric) const;

  /// Returns the metres of one unit of easting.
  double unit_metres() const;
  /// Returns PROJ's name of the CRS, for people: "WGS 84 / UTM zone 33N".
  const std::string& name() const;
  /// Returns the surface below the map's heights, for people: kEllipsoid, or PROJ's name of the
  /// heights ("EGM96 height"); empty if it has none, being geocentric.
  std::string heights() const;
  /// Returns how far off the change of datum may be, in metres; 0 if there is none, below 0 if not
  /// known.
  double accuracy() const;
  /// Returns whether the datum is not known and was taken as WGS 84.
  bool takes_datum_as_wgs84() const;
  /// Returns whether the CRS is meant for that place; true if PROJ does not know.
  bool is_meant_for(const Geodetic& place) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace meshhier::geodesy
