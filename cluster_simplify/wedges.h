// Attributes of a contracted tile: which wedges its places have, and which old ones they stand for.
//
// Methods contract places and know nothing of wedges; this comes after any of them. A new wedge is
// a chart of the texture, a group of normals and a group of colours that some corner shows
// together: textures do not blend across seams, hard edges stay hard, and shading stays smooth
// across a seam of the texture.
#pragma once

#include "cluster_simplify/seams.h"
#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attributes.h"
#include "hierarchy/build_tile.h"

#include <vector>

namespace meshhier::cluster_simplify {

/// The wedges at the representatives of a contraction, by its numbers.
struct ContractedWedges {
  std::vector<float> attributes;  ///< of the first wedge of each, as VertexArray's
  Copies copies;
  WedgeMap map;  ///< of all own places and their copies
};

/// Requires that `joined` has copies. Representatives keep what the contraction gave them if no
/// triangle shows them any more, or if their places had no copies and are one piece of surface, of
/// one chart. Other places have wedges that triangles show, in the order of the first old wedges
/// that they stand for; no two are equal.
/// Old wedges without a triangle that survives go to the nearest of their chart, or of their place.
/// Pure, deterministic; O(n log n), however many wedges or triangles meet at a place.
ContractedWedges contract_wedges(const BuildTile& joined, const Contraction& contraction,
                                 const AttributeLayout& layout, const WedgeOptions& options);

}  // namespace meshhier::cluster_simplify
