// Places of a map in the coordinates of a hierarchy's input.
#pragma once

#include "config/config.h"
#include "geodesy/map_change.h"
#include "geodesy/map_transform.h"
#include "hierarchy/bounds.h"
#include "hierarchy/frame.h"

#include <optional>
#include <string>

namespace meshhier::config {

/// For a hierarchy that its config places on a map, that map; for one that stands on the globe
/// otherwise, its tileset's transform, at the middle height of the input.
class MapPlaces {
 public:
  /// `crs`: of the places. `bounds`: of the input. `transform`: of the tileset's root. Throws
  /// Error(usage) if the hierarchy stands nowhere, and as geodesy::MapChange.
  MapPlaces(const Config& config, const BoundsD& bounds, const std::optional<Transform>& transform,
            const std::string& crs);

  /// Easting and northing, or longitude and latitude, as z-up coordinates of the input; the third
  /// one means nothing. Throws as geodesy::MapChange.
  Vec3d to_input(double x, double y) const;

 private:
  geodesy::MapChange change_;
  geodesy::MappedModel model_;  ///< of what has a crs
  /// A model that is placed by a transform.
  struct OnGlobe {
    geodesy::MapChange to_geocentric;
    double height = 0;  ///< metres above the ellipsoid
    Transform transform{};
  };
  std::optional<OnGlobe> globe_;
};

}  // namespace meshhier::config
