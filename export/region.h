// The region that a piece of a mesh is cut out with.
#pragma once

#include "export/asked_objects.h"
#include "export/convex_region.h"
#include "export/plan_region.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>

namespace meshhier::exporting {

/// A box, polygons seen from above, or the part of space in both; of objects that are asked for
/// what lies there. Thread-safe.
struct Region {
  std::optional<ConvexRegion> box;
  std::shared_ptr<const PlanRegion> plan;
  std::shared_ptr<const AskedObjects> objects;  ///< null: all triangles

  /// Returns whether it takes whatever there is.
  bool is_all() const { return !box && !plan && !objects; }
  /// Returns false only if no point of the box lies in it.
  bool may_meet(const BoundsD& bounds) const {
    return (!box || box->may_meet(bounds)) && (!plan || plan->may_meet(bounds));
  }
  /// Returns false only if the node's tile shows nothing of it in this box.
  bool may_show(NodeId node, const BoundsD& bounds) const {
    return may_meet(bounds) && (!objects || objects->may_show(node));
  }
  /// Returns whether it has triangles with such a corner, wherever they lie.
  bool takes(std::span<const float> attributes) const {
    return !objects || objects->has(attributes);
  }
  bool contains(Vec3d p) const {
    return (!box || box->contains(p)) && (!plan || plan->contains(p));
  }
};

}  // namespace meshhier::exporting
