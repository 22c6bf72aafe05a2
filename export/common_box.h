// What two boxes have in common.
#pragma once

#include "base/bounds.h"

#include <algorithm>

namespace meshhier::exporting {

/// Returns the box that lies in both; an empty one if they are apart.
inline BoundsD common_part(const BoundsD& a, const BoundsD& b) {
  const BoundsD box{
      {std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
      {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
  const bool is_apart = box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z;
  return is_apart ? BoundsD{} : box;
}

}  // namespace meshhier::exporting
