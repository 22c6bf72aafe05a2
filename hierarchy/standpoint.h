// From where a model is looked at.
#pragma once

#include <cmath>

namespace meshhier {

/// Degrees: from the model's front to its right, and above its equator. The front is where +z is if
/// y is up, and -y if z is.
struct Standpoint {
  double azimuth = 0;    ///< -360 to 360
  double elevation = 0;  ///< -90 to 90
  friend bool operator==(const Standpoint&, const Standpoint&) = default;

  bool is_sound() const { return std::abs(azimuth) <= 360 && std::abs(elevation) <= 90; }
};

}  // namespace meshhier
