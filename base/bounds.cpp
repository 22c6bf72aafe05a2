#include "base/bounds.h"

namespace meshhier {

Bounds bounds_of(std::span<const Vec3f> points) {
  Bounds bounds;
  for (const Vec3f& p : points)
    bounds.add(p);
  return bounds;
}

double diagonal(const Bounds& bounds) {
  return bounds.empty() ? 0.0 : length(to_double(bounds.max) - to_double(bounds.min));
}

}  // namespace meshhier
