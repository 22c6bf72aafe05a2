// The seam between tiles of one level: how far it moved when all of them had been contracted.
//
// A tile is contracted with its ghosts held in place, and its deviation says how far its own
// surface went (deviation.h). Then the neighbours' vertices move as well, and take the border
// triangles with them. What that adds is measured here, from what the tiles show of themselves
// (SeamStrip): of every border triangle as it was when its tile was made, how far it is from what
// is drawn now around its corners; and of every border triangle that is drawn now, how far it is
// from what the tiles were then.
#pragma once

#include "cluster_simplify/seams.h"

#include <cstdint>
#include <functional>
#include <span>

namespace meshhier::cluster_simplify {

/// What a contracted tile shows to its neighbours. `joined`: what it was made of. O(n).
SeamStrip make_seam_strip(const BuildTile& joined, const ContractedTile& contracted);

struct SeamStripOf {
  std::uint32_t tile = 0;  ///< index of the node in its level
  SeamStrip seam_strip;
};

/// A tile and all that is around it when its level is complete.
struct SeamInput {
  const TileMesh& mesh;  ///< as drawn now
  const SeamStripOf& own;
  std::span<const GhostRef> mapped;  ///< of own.seam strip.foreign: at the tile's own level
  /// Asked once for each tile that mesh.ghosts name, ascending: one seam strip at a time is held.
  std::function<SeamStrip(std::uint32_t tile)> seam_strip_of_neighbour;
};

/// The largest distance along the seam that a step of one level took, the deviations of both sides
/// counted: from the finer level to the drawn seam and back. Of border triangles that are drawn
/// now, those whose lowest tile this one is. Values below own.seam strip.interior_deviation, which
/// decide nothing, may be any up to that. Infinite if nothing is drawn near a border triangle.
/// O(border).
double seam_gap(const SeamInput& input);

}  // namespace meshhier::cluster_simplify
