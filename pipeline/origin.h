// Where the origin of a hierarchy lies: what is subtracted from coordinates before they are stored
// as floats (docs/decisions/023-one-origin.md).
#pragma once

#include "hierarchy/bounds.h"
#include "hierarchy/vec.h"

#include <span>

namespace meshhier::pipeline {

/// Whether some coordinate of the box is more than twice as large as its longest side. Along such
/// an axis the low and the high end differ by less than a factor of two.
bool is_far_from_zero(const BoundsD& box);

/// Along axes whose coordinates are more than twice the longest side of the box, a number of few
/// binary digits near the middle; 0 along others. Floats within the box stay exact: the difference
/// of two floats within a factor of two is one (Sterbenz 1974). 0 of an empty box.
Vec3d origin_of(const BoundsD& box);

/// Whether a few points may have stretched the box of all: `sample` fills less than a sixteenth of
/// it along one of its longer sides. O(n).
bool may_have_strays(std::span<const Vec3d> sample, const BoundsD& box);

}  // namespace meshhier::pipeline
