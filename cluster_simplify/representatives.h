// From collapsed edges to a contraction: what is left, and where the leftovers go.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/contraction.h"
#include "cluster_simplify/deviation_meter.h"
#include "cluster_simplify/local_frame.h"

#include <cstdint>

namespace meshhier::cluster_simplify {

/// A joined tile after its edges have collapsed.
struct CollapsedTile {
  const TileMesh& joined;
  CollapseMesh& mesh;
  const VertexArray& vertices;  ///< own; those that others were collapsed into at their new places
  std::span<const Vec3f> places;  ///< the same and ghosts', in `frame`
  const LocalFrame& frame;
  const DeviationMeter& deviation;
  FallbackCounts fallbacks = {};
};

/// Makes the contraction out of the collapses carried out in a tile.
///
/// Vertices without triangles show nothing and would fill the coarse tiles: they go into the
/// nearest vertex that has some, but for as many as it takes to have `target` representatives;
/// those are spread evenly among them, and others may go into these. If more than `target` vertices
/// have triangles, and no edge between them is left, those nearest to each other are joined, at the
/// vertex nearest to the middle of those that meet. O(n log n).
Contraction choose_representatives(const CollapsedTile& tile, std::uint32_t target);

}  // namespace meshhier::cluster_simplify
