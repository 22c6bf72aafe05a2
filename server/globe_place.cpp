#include "server/globe_place.h"

#include "hierarchy/frame.h"

#include <cmath>
#include <numbers>

namespace meshhier::server {
namespace {

// WGS 84.
constexpr double kAxis = 6378137;
constexpr double kFlattening = 1 / 298.257223563;
constexpr double kShortAxis = kAxis * (1 - kFlattening);
constexpr double kEccentricity = kFlattening * (2 - kFlattening);  // squared
constexpr double kHighest = 200'000;
constexpr double kDegrees = 180 / std::numbers::pi;

Vec3d transformed(const Transform& m, Vec3d p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
          m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

}  // namespace

std::optional<GlobePlace> place_on_globe(Vec3d point) {
  const double distance = length(point);
  if (!(distance > kShortAxis - kHighest && distance < kAxis + kHighest))
    return std::nullopt;
  const double across = std::hypot(point.x, point.y);
  const double angle = std::atan2(point.z * kAxis, across * kShortAxis);
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const double ahead = kEccentricity / (1 - kEccentricity) * kShortAxis * sine * sine * sine;
  const double back = kEccentricity * kAxis * cosine * cosine * cosine;
  return GlobePlace{std::atan2(point.y, point.x) * kDegrees,
                    std::atan2(point.z + ahead, across - back) * kDegrees};
}

std::optional<GlobePlace> place_on_globe(const storage::Manifest& manifest) {
  if (!manifest.transform)
    return std::nullopt;
  const auto& bounds = manifest.source.bounds;
  const Vec3d middle = (bounds.min + bounds.max) * 0.5;
  return place_on_globe(transformed(*manifest.transform, to_z_up(middle, manifest.up)));
}

}  // namespace meshhier::server
