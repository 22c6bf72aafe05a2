// Turns what a raster holds into a picture.
#pragma once

#include "images/image.h"
#include "render/raster.h"

namespace meshhier::render {

/// What falls on a surface. `none`: colours have their light already.
enum class Light { lamps, none };

/// Lamps: light from a soft lamp at the upper left, a weaker one at the right, and a sky above a
/// floor; the lights move with the viewer. The samples of a pixel are averaged as light; alpha is
/// the share of those that the surface covers, and 0, 0, 0, 0 where there is none. 4 channels.
images::Image shade(const Raster& raster, Light light = Light::lamps);

}  // namespace meshhier::render
