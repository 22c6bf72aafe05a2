// Turns what a raster holds into a picture.
#pragma once

#include "render/raster.h"

#include <cstdint>
#include <vector>

namespace meshhier::render {

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 width height: sRGB, alpha not multiplied in; row by row
};

/// Light from a soft lamp at the upper left, a weaker one at the right, and a sky above a floor;
/// the lights move with the viewer. The samples of a pixel are averaged as light; alpha is the
/// share of those that the surface covers, and 0, 0, 0, 0 where there is none.
Picture shade(const Raster& raster);

}  // namespace meshhier::render
