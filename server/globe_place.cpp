#include "server/globe_place.h"

#include "base/angle.h"
#include "base/wgs84.h"
#include "hierarchy/frame.h"

#include <cmath>
#include <numbers>

namespace meshhier::server {
namespace {

constexpr double kHighest = 200'000;
constexpr double kDegrees = 180 / std::numbers::pi;

Vec3d transformed(const Transform& m, Vec3d p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
          m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

double signed_degrees(double x, double y) {
  return std::copysign(angle_of(x, std::abs(y)), y) * kDegrees;
}

}  // namespace

// By Bowring, 1976: off by a micrometre 10 km above the ellipsoid, by 0.4 mm at the highest.
std::optional<GlobePlace> place_on_globe(Vec3d point) {
  using namespace wgs84;
  const double distance = length(point);
  if (!(distance > kPole - kHighest && distance < kEquator + kHighest))
    return std::nullopt;
  const double across = std::sqrt(point.x * point.x + point.y * point.y);
  const double along = across * kPole, up = point.z * kEquator;
  const double size = std::sqrt(along * along + up * up);
  const double cosine = along / size, sine = up / size;
  const double ahead = kEccentricity2 / (1 - kEccentricity2) * kPole * sine * sine * sine;
  const double back = kEccentricity2 * kEquator * cosine * cosine * cosine;
  return GlobePlace{signed_degrees(point.x, point.y),
                    signed_degrees(across - back, point.z + ahead)};
}

std::optional<GlobePlace> place_on_globe(const storage::Manifest& manifest) {
  if (!manifest.transform)
    return std::nullopt;
  const auto& bounds = manifest.source.bounds;
  const Vec3d middle = (bounds.min + bounds.max) * 0.5;
  return place_on_globe(transformed(*manifest.transform, to_z_up(middle, manifest.up)));
}

}  // namespace meshhier::server
