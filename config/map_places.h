// Places of a map in the coordinates of a hierarchy's input.
#pragma once

#include "base/bounds.h"
#include "config/config.h"
#include "geodesy/map_change.h"
#include "geodesy/map_transform.h"
#include "hierarchy/frame.h"

#include <optional>
#include <string>

namespace meshhier::config {

/// Turns places into coordinates: by the map that a config places its hierarchy on, or, if it
/// stands on the globe otherwise, by its tileset's transform, at the middle height of the input.
class MapPlaces {
 public:
  /// `crs`: the places'. `bounds`: the input's. `transform`: the tileset's root's. Throws
  /// Error(usage) if the hierarchy stands nowhere, and as geodesy::MapChange.
  MapPlaces(const Config& config, const BoundsD& bounds, const std::optional<Transform>& transform,
            const std::string& crs);

  /// Returns easting and northing, or longitude and latitude, as z-up coordinates of the input; the
  /// third one means nothing. Throws as geodesy::MapChange.
  Vec3d to_input(double x, double y) const;

 private:
  geodesy::MapChange change_;
  geodesy::MappedModel model_;  ///< only if the config has a crs
  /// A model that is placed by a transform.
  struct OnGlobe {
    geodesy::MapChange to_geocentric;
    double height = 0;  ///< metres above the ellipsoid
    Transform transform{};
  };
  std::optional<OnGlobe> globe_;
};

}  // namespace meshhier::config
