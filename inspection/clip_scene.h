// What of a tile's picture lies in a region.
#pragma once

#include "export/region.h"
#include "render/scene.h"

namespace meshhier::inspection {

/// Facets cut where the region ends, with their skins; those without area, which stand for points,
/// stay if they lie in it. O(t).
render::SceneTile clip_scene(render::SceneTile tile, const exporting::Region& region);

}  // namespace meshhier::inspection
