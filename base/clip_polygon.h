// Polygons cut at a plane.
#pragma once

#include <cstddef>
#include <vector>

namespace meshhier {

/// Fills `left` with what of a convex polygon is not beyond a plane (Sutherland & Hodgman,
/// Reentrant Polygon Clipping, 1974). beyond(corner): its distance, positive on the far side;
/// cut(from, to, a, b): the corner between two whose distances are a and b. O(n).
template <class Corner, class Beyond, class Cut>
void clip_at(const std::vector<Corner>& polygon, const Beyond& beyond, const Cut& cut,
             std::vector<Corner>& left) {
  left.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner& from = polygon[i];
    const Corner& to = polygon[(i + 1) % polygon.size()];
    const double a = beyond(from), b = beyond(to);
    if (!(a > 0))
      left.push_back(from);
    if ((a < 0 && b > 0) || (a > 0 && b < 0))
      left.push_back(cut(from, to, a, b));
  }
}

}  // namespace meshhier
