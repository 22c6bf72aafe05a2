// The part of a tile's mesh that lies in a region.
#pragma once

#include "export/cut_part.h"
#include "export/region.h"
#include "hierarchy/attribute_rules.h"

#include <cstdint>
#include <limits>

namespace meshhier::exporting {

enum class Clipping : std::uint8_t {
  whole_triangles,  ///< triangles that touch the region
  at_border         ///< triangles within it, cut where it ends
};

/// CutPart::places has this for a vertex where an edge was cut.
inline constexpr std::uint32_t kNoPlace = std::numeric_limits<std::uint32_t>::max();

/// Returns the part within the region. Triangles stay in their order, the pieces of one side by
/// side; vertices that they use come in the part's order, then those that cutting made.
/// TriangleClipper and CornerMixer make these, so no gap opens. Without a triangle there is no
/// picture. O(t), and PlanRegion::cut() for each triangle that a polygon's border crosses. Throws
/// as Region's check.
CutPart clip_part(const CutPart& part, const AttributeRules& rules, const Region& region,
                  Clipping clipping);

}  // namespace meshhier::exporting
