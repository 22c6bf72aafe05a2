#include "geodesy/map_transform.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::geodesy {
namespace {

/// Metres. Differences over twice as much are a few 1e-9 off by their length, and a few 1e-12 by
/// the last bits of geocentric coordinates.
constexpr double kStep = 1000;

double rounded(double value, int bits) {
  return std::ldexp(std::round(std::ldexp(value, bits)), -bits);
}

Vec3d rounded(Vec3d p, int bits) {
  return {rounded(p.x, bits), rounded(p.y, bits), rounded(p.z, bits)};
}

Vec3d derivative(const MapProjection& projection, Vec3d map, Vec3d axis) {
  const double step = kStep / projection.unit_metres();
  const Vec3d ahead = projection.to_geocentric(map + axis * step);
  const Vec3d behind = projection.to_geocentric(map - axis * step);
  return (ahead - behind) * (1 / (2 * step));
}

Vec3d applied(const Transform& m, Vec3d p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
          m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

}  // namespace

Transform map_transform(const MapProjection& projection, const MappedModel& model) {
  constexpr int kDerivativeBits = 27;
  constexpr int kPlaceBits = 13;
  const Vec3d map = model.to_map(model.anchor);
  const auto along = [&](Vec3d axis) {
    return rounded(derivative(projection, map, axis), kDerivativeBits) * model.scale;
  };
  const Vec3d x = along({1, 0, 0}), y = along({0, 1, 0}), z = along({0, 0, 1});
  const Vec3d place = rounded(projection.to_geocentric(map), kPlaceBits);
  const Vec3d a = model.anchor;
  const Vec3d shift = place - (x * a.x + y * a.y + z * a.z);
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, shift.x, shift.y, shift.z, 1};
}

double largest_error(const MapProjection& projection, const MappedModel& model,
                     const Transform& transform, const BoundsD& box) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p{(corner & 1) != 0 ? box.max.x : box.min.x,
                  (corner & 2) != 0 ? box.max.y : box.min.y,
                  (corner & 4) != 0 ? box.max.z : box.min.z};
    const Vec3d exact = projection.to_geocentric(model.to_map(p));
    const double off = length(applied(transform, p) - exact);
    largest = std::max(largest, std::isfinite(off) ? off : std::numeric_limits<double>::infinity());
  }
  return largest;
}

}  // namespace meshhier::geodesy
