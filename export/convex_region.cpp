#include "export/convex_region.h"

#include <algorithm>

namespace meshhier::exporting {

ConvexRegion ConvexRegion::of_box(const BoundsD& box) {
  const auto sides = half_spaces_of(box);
  return ConvexRegion({sides.begin(), sides.end()});
}

bool ConvexRegion::may_meet(const BoundsD& box) const {
  return std::ranges::all_of(half_spaces_, [&](const HalfSpace& half) {
    const Vec3d& n = half.normal;
    const Vec3d innermost{n.x > 0 ? box.min.x : box.max.x, n.y > 0 ? box.min.y : box.max.y,
                          n.z > 0 ? box.min.z : box.max.z};
    return half.beyond(innermost) <= 0;
  });
}

}  // namespace meshhier::exporting
