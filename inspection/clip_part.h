// What of a tile's mesh lies in a region.
#pragma once

#include "hierarchy/attributes.h"
#include "inspection/convex_region.h"
#include "inspection/cut_part.h"

#include <cstdint>
#include <limits>

namespace meshhier::inspection {

enum class Clipping : std::uint8_t {
  whole_triangles,  ///< those that touch the region
  at_border         ///< what lies in it, cut where it ends
};

/// CutPart::places of a vertex where an edge was cut.
inline constexpr std::uint32_t kNoPlace = std::numeric_limits<std::uint32_t>::max();

/// Triangles in their order, the pieces of one as a fan; vertices that they use in the part's
/// order, then those where edges were cut. Triangles that share an edge, with the same values at
/// its ends, get the same vertex on it, bit for bit: no gap opens. Positions, normals, texture
/// coordinates and attributes are interpolated; colours of integers are rounded. On a side of a box
/// a vertex has the side's coordinate, rounded to float. Without a triangle there is no picture.
/// O(t).
CutPart clip_part(const CutPart& part, const AttributeLayout& layout, const ConvexRegion& region,
                  Clipping clipping);

}  // namespace meshhier::inspection
