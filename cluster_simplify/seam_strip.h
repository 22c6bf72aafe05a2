// Measures how far the seam between tiles of one level moved when all of them were contracted.
//
// Problem. A tile is contracted with its ghosts held in place, and its deviation says how far its
// own surface went (deviation.h). Then the neighbours' vertices move as well, and take the border
// triangles with them. `bound` must count that, in both directions, though no tile sees it happen.
//
// Idea. Each tile keeps what the seam looked like when it was made: its seam strip, a few kilobytes
// of border triangles and of interior ones at boundary vertices. When the level is complete, a tile
// is loaded with its neighbours' seam strips, and two surfaces are compared around each corner:
//
//          then: own vertices contracted,           now: as it is drawn, when the
//          ghosts where they were                   neighbour is contracted, too
//
//             own       |  neighbour                   own       |  neighbour
//          --o-----o----|--g-----o--                --o-----o----|-----g'-o--
//             \   / \   | / \   /        <---->        \   / \   |   .'  /
//              \ /   \  |/   \ /         both           \ /   \  |  .'  /
//          -----o-----o-|-----g---       ways        ----o-----o-|---g'---
//
//   - Each border triangle as it was *then* must be near what is drawn *now* around its corners.
//   - Each border triangle that is drawn *now* must be near what the tiles were *then*, which adds
//     their own deviations.
//
//  Interior triangles at the boundary did not move after their tile was made: they are in both
//  surfaces and serve as covers (cover_distance.h), but are not asked about.
//
// Invariant. A triangle drawn now is asked about by the lowest tile that has it, a triangle of then
// by each tile whose strip has it: so all are, and the largest result of the level is its seam
// deviation.
//
// Cost. O(border) triangles, each against at most 3 * 64 covers; most are settled by one of the
// first three, which share an edge with them. Memory: the own strip, what is drawn, and about as
// many triangles of neighbours, one neighbour's strip at a time.
#pragma once

#include "cluster_simplify/seams.h"

#include <cstdint>
#include <functional>
#include <span>

namespace meshhier::cluster_simplify {

/// Makes what a contracted tile shows to its neighbours. `joined`: the tile it was made of. O(n).
SeamStrip make_seam_strip(const BuildTile& joined, const ContractedTile& contracted);

struct SeamStripOf {
  std::uint32_t tile = 0;  ///< index of the node in its level
  SeamStrip seam_strip;
};

/// A tile and all that is around it when its level is complete.
struct SeamInput {
  const TileMesh& mesh;  ///< as drawn now
  const SeamStripOf& own;
  std::span<const GhostRef> mapped;  ///< own.seam_strip.foreign at the tile's own level
  /// Asked once for each tile that mesh.ghosts name, ascending: one seam strip at a time is held.
  std::function<SeamStrip(std::uint32_t tile)> seam_strip_of_neighbour;
};

/// Returns the largest distance along the seam that the step of one level took, the deviations of
/// both sides counted: from the finer level to the drawn seam and back. Border triangles that are
/// drawn now count in the lowest tile that has them. A result that is not above
/// own.seam_strip.interior_deviation decides nothing and may be any value up to that. Infinite if
/// nothing is drawn near a border triangle. Throws Error(internal) if a ghost lies outside its
/// tile's boundary, and what `seam_strip_of_neighbour` throws.
double seam_gap(const SeamInput& input);

}  // namespace meshhier::cluster_simplify
