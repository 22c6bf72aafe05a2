// The map that moves the first of two surfaces before they are compared.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::comparing {

/// An affine map as 4 x 4 numbers, rows first; the last row is 0 0 0 1.
using PlaceTransform = std::array<double, 16>;

/// Reads sixteen numbers between blanks, commas and brackets, perhaps behind a byte order mark.
/// `name` begins messages. Throws Error(usage) if they are not so many, not finite, no affine map,
/// or one that makes all flat.
PlaceTransform parse_transform(std::string_view text, const std::string& name);

/// Returns where a point or box goes; without a transform it stays.
Vec3d moved(const std::optional<PlaceTransform>& transform, Vec3d p);
BoundsD moved_box(const std::optional<PlaceTransform>& transform, const BoundsD& box);

}  // namespace meshhier::comparing
