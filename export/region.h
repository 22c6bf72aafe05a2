// The region that a piece of a mesh is cut out with.
#pragma once

#include "export/convex_region.h"
#include "export/plan_region.h"

#include <algorithm>
#include <memory>
#include <optional>

namespace meshhier::exporting {

/// A box, polygons seen from above, or the part of space in both. Thread-safe.
struct Region {
  std::optional<ConvexRegion> box;
  std::shared_ptr<const PlanRegion> plan;

  /// Returns false only if no point of the box lies in it.
  bool may_meet(const BoundsD& bounds) const {
    return (!box || box->may_meet(bounds)) && (!plan || plan->may_meet(bounds));
  }
  bool contains(Vec3d p) const {
    return (!box || box->contains(p)) && (!plan || plan->contains(p));
  }
};

}  // namespace meshhier::exporting
