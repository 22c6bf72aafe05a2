// The part of a tile's picture that lies in a region.
#pragma once

#include "export/region.h"
#include "render/scene.h"

namespace meshhier::inspection {

/// Cuts facets, with their skins, where the region ends; those without area, which stand for
/// points, stay if they lie in it. O(t).
render::SceneTile clip_scene(render::SceneTile tile, const exporting::Region& region);

}  // namespace meshhier::inspection
