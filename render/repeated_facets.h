// Triangles that lie exactly where an earlier one does: nothing is seen of them.
#pragma once

#include "render/facet.h"

#include <vector>

namespace meshhier::render {

/// Drops facets whose corners have the positions of an earlier one's, in its order, and their skins
/// (one for each facet, or none). Remembers a few thousand facets, so some may stay. A raster shows
/// the same without them. Linear, in little memory.
void drop_repeated(std::vector<Facet>& facets, std::vector<Skin>& skins);

}  // namespace meshhier::render
