// The origin of a hierarchy is subtracted from coordinates before they are stored as floats
// (docs/decisions/023-one-origin.md).
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <cstdint>
#include <span>

namespace meshhier::pipeline {

/// Whether some coordinate of the box is more than twice as large as its longest side. Along such
/// an axis the low and the high end differ by less than a factor of two.
bool is_far_from_zero(const BoundsD& box);

/// Returns, along axes whose coordinates are more than twice the longest side of the box, a number
/// of few binary digits near the middle; 0 along others and for an empty box. Floats within the box
/// stay exact: the difference of two floats within a factor of two is one (Sterbenz 1974).
Vec3d origin_of(const BoundsD& box);

/// Returns the box that nearly all points of a sample are in: along each axis it leaves out as many
/// of them at both ends: a thirty-second part, rounded up, or none of fewer than eight points.
/// O(n). Empty if there are no points.
BoundsD core_of(std::span<const Vec3d> sample);

/// The point that is subtracted from coordinates.
struct Origin {
  Vec3d at;
  BoundsD near = kEverywhere;  ///< vertices outside are far from nearly all others

  static constexpr BoundsD kEverywhere{{-BoundsD::kHigh, -BoundsD::kHigh, -BoundsD::kHigh},
                                       {BoundsD::kHigh, BoundsD::kHigh, BoundsD::kHigh}};
};

/// Returns origin_of() the box of all vertices, if floats then keep nearly all of them apart along
/// each axis: half a float's last digit is no more than a thousandth of the mean distance that
/// `count` vertices have along the axis of their core. Else returns origin_of() the core, and along
/// axes where even that does not do, whatever the others are like, a number near the core's middle.
/// Coordinates of the core stay exact as above.
Origin choose_origin(const BoundsD& all, const BoundsD& core, std::uint64_t count);

/// Whether choose_origin() may find one for the vertices that triangles use, if `sample` and the
/// box are those of all. O(n).
bool may_need_origin(std::span<const Vec3d> sample, const BoundsD& all, std::uint64_t count);

/// Returns how far floats relative to the origin are off at nearly all points of the sample, at
/// most. O(n).
double rounding_of(std::span<const Vec3d> sample, Vec3d origin);

/// Whether a few points may have stretched the box of all: `sample` fills less than a sixteenth of
/// it along one of its longer sides. O(n).
bool may_have_strays(std::span<const Vec3d> sample, const BoundsD& box);

}  // namespace meshhier::pipeline
