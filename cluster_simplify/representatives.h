// Makes a contraction out of collapsed edges: who is left, who stands for whom, and how far the
// surface moved.
//
// Problem. Collapses end with too many vertices (no edge is left that may go) or with vertices that
// no triangle shows, and a contraction must have exactly `target` representatives. Whatever is done
// about that moves or loses surface, and must enter the deviation.
//
// Idea. Three kinds of own vertices are left:
//
//      shown     has a triangle      a representative; if they are more than `target`, kd cells of
//                                    neighbours join at the vertex nearest to the cell's mean
//      isolated  has none            goes into the nearest shown one; some of them stay, evenly
//                                    spread, if there are fewer shown ones than `target`
//      gone      was collapsed       into the one that stands for its representative
//
//      parent_of:   gone --representative()--> left --into--> chosen, numbered 0 ... target - 1
//
// Deviation (DeviationSum) has three sources: what the collapses moved (DeviationMeter), how far
// corners went by joining, and triangles that are drawn no more, each measured against what is
// still drawn around the nearest drawn vertex.
//
// Invariant. Each triangle that was alive after the collapses is either drawn, and raises `around`
// at its corners, or lost, and raises `lost`: no surface goes uncounted.
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

/// Makes the contraction out of the collapses carried out in a tile. Vertices without triangles
/// show nothing and would fill the coarse tiles, so only as many of them stay as it takes to have
/// `target` representatives. Pure, deterministic; O(n log n).
Contraction choose_representatives(const CollapsedTile& tile, std::uint32_t target);

}  // namespace meshhier::cluster_simplify
