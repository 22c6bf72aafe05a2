#include "cluster_simplify/local_frame.h"

#include "base/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::cluster_simplify {

LocalFrame::LocalFrame(const Bounds& bounds) {
  if (bounds.empty())
    return;
  middle_ = (to_double(bounds.min) + to_double(bounds.max)) * 0.5;
  const Vec3d half = to_double(bounds.max) - middle_;
  const double size = std::max({half.x, half.y, half.z});
  int exponent = 0;
  std::frexp(size, &exponent);  // size < 2^exponent
  if (size > 0)
    scale_ = std::ldexp(1.0, -exponent);
  // Half a unit in the last place, there and back, along three axes.
  const Vec3d most = to_double(bounds.max);
  const Vec3d least = to_double(bounds.min);
  rounding_ = 0x1p-22 * std::max({std::abs(most.x), std::abs(most.y), std::abs(most.z),
                                  std::abs(least.x), std::abs(least.y), std::abs(least.z)});
}

Vec3f LocalFrame::to_local(Vec3f position) const {
  return to_float((to_double(position) - middle_) * scale_);
}

std::vector<Vec3f> LocalFrame::to_local(std::span<const Vec3f> positions) const {
  std::vector<Vec3f> local(positions.size());
  std::transform(positions.begin(), positions.end(), local.begin(),
                 [&](Vec3f p) { return to_local(p); });
  return local;
}

Vec3f LocalFrame::to_global(Vec3f local) const {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const Vec3d place = middle_ + to_double(local) * (1 / scale_);
  return to_float(Vec3d{std::clamp(place.x, -kLargest, kLargest),
                        std::clamp(place.y, -kLargest, kLargest),
                        std::clamp(place.z, -kLargest, kLargest)});
}

}  // namespace meshhier::cluster_simplify
