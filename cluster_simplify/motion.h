// How far representatives are from the vertices they stand for, as a bound of how far the surface
// moved.
#pragma once

#include "cluster_simplify/deviation.h"
#include "cluster_simplify/seams.h"
#include "hierarchy/build_tile.h"

namespace meshhier::cluster_simplify {

/// The deviation of a contraction about whose map nothing is known but where it takes vertices:
/// each triangle's image is as near to it as its corners are to theirs. Counts motion within the
/// surface. Requires parent_of and representatives. O(n).
Deviation motion_of(const BuildTile& joined, const Contraction& contraction);

}  // namespace meshhier::cluster_simplify
