#include "base/ray.h"

namespace meshhier {
namespace {

/// Returns what a product of doubles loses by rounding (Dekker 1971). Requires that nothing
/// overflows.
double lost(double a, double b, double product) {
  constexpr double kSplit = 0x1p27 + 1;
  const auto high = [](double x) {
    const double scaled = x * kSplit;
    return scaled - (scaled - x);
  };
  const double a1 = high(a), a2 = a - a1, b1 = high(b), b2 = b - b1;
  return ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2;
}

/// Returns the side of the line from a to b that the origin of the plane is on: above 0, below, or
/// 0 on it. Changes its sign, and nothing else, if a and b are swapped.
double side(const Vec3d& a, const Vec3d& b) {
  constexpr double kSure = 0x1p-50;
  const double left = a.x * b.y, right = a.y * b.x, difference = left - right;
  if (std::abs(difference) > kSure * (std::abs(left) + std::abs(right)))
    return difference;
  return difference + (lost(a.x, b.y, left) - lost(a.y, b.x, right));
}

}  // namespace

Ray::Ray(Vec3d origin, Vec3d direction) : origin_(origin), direction_(direction), axes_{0, 1, 2} {
  const auto inverse = [](double part) { return std::abs(part) > kStill ? 1 / part : 0; };
  inverse_ = {inverse(direction.x), inverse(direction.y), inverse(direction.z)};
  const Vec3d size{std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)};
  const int last = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  axes_ = {(last + 1) % 3, (last + 2) % 3, last};
  const double along = direction[last];
  shear_ = {direction[axes_[0]] / along, direction[axes_[1]] / along, 1 / along};
}

Vec3d Ray::sheared(const Vec3f& corner) const {
  const Vec3d p = to_double(corner) - origin_;
  const double along = p[axes_[2]];
  return {p[axes_[0]] - shear_.x * along, p[axes_[1]] - shear_.y * along, shear_.z * along};
}

std::optional<double> Ray::hit(const Vec3f& corner_a, const Vec3f& corner_b,
                               const Vec3f& corner_c) const {
  const Vec3d a = sheared(corner_a), b = sheared(corner_b), c = sheared(corner_c);
  const double u = side(b, c), v = side(c, a), w = side(a, b);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
    return std::nullopt;
  const double all = u + v + w;
  if (all == 0)
    return std::nullopt;
  const double distance = (u / all) * a.z + (v / all) * b.z + (w / all) * c.z;
  if (!(distance >= 0))
    return std::nullopt;
  const auto [low_x, high_x] = std::minmax({corner_a.x, corner_b.x, corner_c.x});
  const auto [low_y, high_y] = std::minmax({corner_a.y, corner_b.y, corner_c.y});
  const auto [low_z, high_z] = std::minmax({corner_a.z, corner_b.z, corner_c.z});
  const Span box = span(Vec3f{low_x, low_y, low_z}, Vec3f{high_x, high_y, high_z});
  if (box.is_empty())
    return std::nullopt;
  return std::clamp(distance, std::max(box.entry, 0.0), box.exit);
}

}  // namespace meshhier
