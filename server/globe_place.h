// Where on the globe a hierarchy lies, for a map of models.
#pragma once

#include "storage/format/manifest.h"

#include <optional>

namespace meshhier::server {

/// Degrees on WGS 84.
struct GlobePlace {
  double longitude = 0;  ///< -180 to 180
  double latitude = 0;   ///< -90 to 90
  friend bool operator==(const GlobePlace&, const GlobePlace&) = default;
};

/// Returns the place of a point of the earth's axes, in metres, to a few millionths of a degree
/// near the ground (Bowring 1976, one step). Nothing if it is not within 200 km of the ground.
std::optional<GlobePlace> place_on_globe(Vec3d point);

/// Returns the place of the middle of a hierarchy's box; nothing if its transform leads elsewhere.
std::optional<GlobePlace> place_on_globe(const storage::Manifest& manifest);

}  // namespace meshhier::server
