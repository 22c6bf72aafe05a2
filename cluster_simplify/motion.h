// How far a contraction moves the surface, judged by how far it moves vertices.
#pragma once

#include "cluster_simplify/deviation.h"

namespace meshhier::cluster_simplify {

/// A bound and a mean like DeviationMeter::measure(), twenty times as fast and looser by what
/// vertices move within the surface; Deviation::squared_sum is of vertices' motion. A fine triangle
/// is drawn where the linear map of its corners takes it; one whose image has no area is compared
/// with a corner of that which is drawn. For contractions that fold the surface, as cells do:
/// distances to folds are no smaller, and take long to certify. O(n).
Deviation measure_motion(const DeviationInput& input);

}  // namespace meshhier::cluster_simplify
