// Places of one map in the coordinates of another, by PROJ.
#pragma once

#include "base/vec.h"

#include <memory>
#include <optional>
#include <string>

namespace meshhier::geodesy {

/// Takes the horizontal parts of two CRSs. Coordinates are easting, northing or, in degrees,
/// longitude, latitude; heights stay as they are, but for those of three-dimensional CRSs
/// ("EPSG:4979", "EPSG:4978").
///
/// An object is for one thread at a time.
class MapChange {
 public:
  /// Takes CRSs as MapProjection does, and also CRSs in degrees. Throws as its constructor.
  MapChange(const std::string& from, const std::string& to);
  ~MapChange();
  MapChange(MapChange&&) noexcept;
  MapChange& operator=(MapChange&&) noexcept;

  /// Settles on the change of datum for a place, if it is one: all others follow it, so that
  /// nothing jumps.
  void settle_at(Vec3d place);

  /// Returns the place on the other map. Throws Error(usage) if there is none.
  Vec3d operator()(Vec3d place) const;
  /// Returns the place on the other map; nothing if there is none.
  std::optional<Vec3d> find(Vec3d place) const;

  /// Returns whether PROJ lacks the way from one datum to the other, and takes both as one.
  bool takes_datums_as_one() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace meshhier::geodesy
