#include "inspection/convex_region.h"

#include <algorithm>

namespace meshhier::inspection {

ConvexRegion ConvexRegion::of_box(const BoundsD& box) {
  return ConvexRegion({{{-1, 0, 0}, -box.min.x},
                       {{1, 0, 0}, box.max.x},
                       {{0, -1, 0}, -box.min.y},
                       {{0, 1, 0}, box.max.y},
                       {{0, 0, -1}, -box.min.z},
                       {{0, 0, 1}, box.max.z}});
}

bool ConvexRegion::may_meet(const BoundsD& box) const {
  return std::ranges::all_of(half_spaces_, [&](const HalfSpace& half) {
    const Vec3d& n = half.normal;
    const Vec3d innermost{n.x > 0 ? box.min.x : box.max.x, n.y > 0 ? box.min.y : box.max.y,
                          n.z > 0 ? box.min.z : box.max.z};
    return half.beyond(innermost) <= 0;
  });
}

}  // namespace meshhier::inspection
