// When attributes of wedges at one place are different ones, not noise of one.
#pragma once

namespace meshhier::cluster_simplify {

struct WedgeOptions {
  double crease_angle = 40;  ///< degrees, 0 to 180: normals that differ by more stay apart
  double colour_tolerance =
      1.0 / 16;  ///< part of the colour type's range: channels that differ by more stay apart
};

}  // namespace meshhier::cluster_simplify
