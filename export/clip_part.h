// What of a tile's mesh lies in a region.
#pragma once

#include "export/cut_part.h"
#include "export/region.h"
#include "hierarchy/attributes.h"

#include <cstdint>
#include <limits>

namespace meshhier::exporting {

enum class Clipping : std::uint8_t {
  whole_triangles,  ///< those that touch the region
  at_border         ///< what lies in it, cut where it ends
};

/// CutPart::places of a vertex where an edge was cut.
inline constexpr std::uint32_t kNoPlace = std::numeric_limits<std::uint32_t>::max();

/// Triangles in their order, the pieces of one side by side; vertices that they use in the part's
/// order, then those that cutting made, as TriangleClipper and CornerMixer make them: no gap opens.
/// Without a triangle there is no picture. O(t), and PlanRegion::cut() of each that a polygon's
/// border crosses.
CutPart clip_part(const CutPart& part, const AttributeLayout& layout, const Region& region,
                  Clipping clipping);

}  // namespace meshhier::exporting
