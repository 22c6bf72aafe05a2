// A convex part of space, by which a piece of a mesh is cut out.
#pragma once

#include "base/bounds.h"
#include "base/half_space.h"
#include "base/vec.h"

#include <vector>

namespace meshhier::exporting {

/// The points that lie in all of some half-spaces. Thread-safe.
class ConvexRegion {
 public:
  explicit ConvexRegion(std::vector<HalfSpace> half_spaces)
      : half_spaces_(std::move(half_spaces)) {}
  /// Returns the region of a box, its faces included.
  static ConvexRegion of_box(const BoundsD& box);

  const std::vector<HalfSpace>& half_spaces() const { return half_spaces_; }
  /// Returns false only if no point of the box lies in it. True says nothing.
  bool may_meet(const BoundsD& box) const;
  bool contains(Vec3d p) const { return may_meet({p, p}); }

 private:
  std::vector<HalfSpace> half_spaces_;
};

}  // namespace meshhier::exporting
