#include "base/half_space.h"

#include "base/clip_polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace meshhier {
namespace {

/// How far beyond a face rounding may move a point of the triangle: the largest sum of the terms of
/// dot(normal, corner), in a double's last digits.
double slack(const HalfSpace& half, const std::array<Vec3d, 3>& corners) {
  constexpr double kRounding = 0x1p-50;
  double largest = 0;
  for (const Vec3d& p : corners) {
    const Vec3d& n = half.normal;
    largest = std::max(largest, std::abs(n.x * p.x) + std::abs(n.y * p.y) + std::abs(n.z * p.z));
  }
  return kRounding * largest;
}

}  // namespace

std::array<HalfSpace, 6> half_spaces_of(const BoundsD& box) {
  return {{{{-1, 0, 0}, -box.min.x},
           {{1, 0, 0}, box.max.x},
           {{0, -1, 0}, -box.min.y},
           {{0, 1, 0}, box.max.y},
           {{0, 0, -1}, -box.min.z},
           {{0, 0, 1}, box.max.z}}};
}

bool touches(std::span<const HalfSpace> half_spaces, const std::array<Vec3d, 3>& corners) {
  std::vector<Vec3d> polygon(corners.begin(), corners.end()), next;
  for (const HalfSpace& half : half_spaces) {
    const double allowed = slack(half, corners);
    clip_at(
        polygon, [&](Vec3d p) { return half.beyond(p) - allowed; },
        [](Vec3d from, Vec3d to, double a, double b) { return from + (to - from) * (a / (a - b)); },
        next);
    std::swap(polygon, next);
  }
  return !polygon.empty();
}

}  // namespace meshhier
