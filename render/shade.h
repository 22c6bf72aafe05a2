// Turns what a raster holds into a picture.
#pragma once

#include "images/image.h"
#include "render/light_rig.h"
#include "render/raster.h"
#include "render/reflection.h"

namespace meshhier::render {

/// The light that falls on a surface. `none`: colours have their light already.
enum class Light { lamps, none };

struct Lighting {
  Light kind = Light::lamps;
  LightRig rig = studio({0, 1, 0});  ///< of lamps
  double roughness = kRoughness;
  bool has_cavities = true;  ///< hollows are darker, edges lighter
};

/// The light of lamps is what the viewer's page shows of it: hollows are darker and edges lighter
/// by how the normal turns within a pixel, and what is too bright is toned down. The samples of a
/// pixel are averaged as light; alpha is the share of those that the surface covers, and 0, 0, 0, 0
/// where there is none. 4 channels.
images::Image shade(const Raster& raster, const Lighting& lighting = {});

}  // namespace meshhier::render
