// Turns what a raster holds into a picture.
#pragma once

#include "images/image.h"
#include "render/raster.h"

namespace meshhier::render {

/// What falls on a surface. `none`: colours have their light already.
enum class Light { lamps, none };

class Occlusion;

struct Lighting {
  Light kind = Light::lamps;
  double exposure = 1;  ///< of lamps: how much of their light counts
  double relief = 1;    ///< slopes are lit as if they were so many times as steep; above 0
  const Occlusion* occlusion = nullptr;  ///< of the same picture; none: all of the sky is seen
};

/// Lamps: light from a soft lamp at the upper left, a weaker one at the right, and a sky above a
/// floor; the lights move with the viewer. The samples of a pixel are averaged as light; alpha is
/// the share of those that the surface covers, and 0, 0, 0, 0 where there is none. 4 channels.
images::Image shade(const Raster& raster, const Lighting& lighting = {});

}  // namespace meshhier::render
