// Whether a mesh is a terrain, and how one is shown: coloured by height, its slopes shaded steeper
// (as viewer/src/scene/terrain.ts and presentation.ts have it).
#pragma once

#include "hierarchy/frame.h"
#include "hierarchy/published.h"
#include "render/facet.h"

#include <optional>
#include <span>

namespace meshhier::render {

struct Terrain {
  Vec3d along;               ///< of the heights, of length 1, along an axis
  bool is_upright = true;    ///< heights go up; otherwise it is a sheet that is seen from its front
  double low = 0, high = 0;  ///< what few vertices lie below and above of
  double slope = 0;          ///< the mean: rise over run

  /// So many times steeper slopes are shaded. `stretch`: heights are shown so many times as high.
  double relief(double stretch = 1) const;
};

/// `root`: the root's tile. Nothing of a mesh of which parts hide others from above. O(n log n).
std::optional<Terrain> terrain_of(const PublishedTile& root, UpAxis up);
/// `up`: along an axis, of length 1.
std::optional<Terrain> terrain_of(const PublishedTile& root, Vec3d up);

/// Where a corner has a normal, as if its slope were so many times as steep; a facet's own stays.
void shade_steeper(const Terrain& terrain, double relief, std::span<Facet> facets);

/// Few vertices lie below `low` or above `high`, along a direction of length 1.
struct HeightRange {
  Vec3d along;
  double low = 0, high = 0;
};
HeightRange heights_of(const TileMesh& mesh, Vec3d along);

/// Lowland green, straw, ochre, rock, snow.
void colour_by_height(const HeightRange& heights, std::span<Facet> facets);

}  // namespace meshhier::render
