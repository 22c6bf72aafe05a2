#include "mesh_io/globe_frame.h"

#include "base/wgs84.h"

#include <algorithm>
#include <cmath>

namespace meshhier::mesh_io {
namespace {

using wgs84::kEquator;
using wgs84::kPole;

/// Returns the direction away from the ellipsoid.
Vec3d up_at(Vec3d p) {
  const Vec3d normal{p.x / (kEquator * kEquator), p.y / (kEquator * kEquator),
                     p.z / (kPole * kPole)};
  return normal * (1 / length(normal));
}

bool is_rigid(const GltfTransform& t) {
  constexpr double kRounded = 1e-6;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = i; k < 3; ++k) {
      if (std::abs(dot(t.rows[i], t.rows[k]) - (i == k ? 1 : 0)) > kRounded)
        return false;
    }
  }
  return !is_mirrored(t);
}

/// Returns the point where the line from the middle of the globe through `p` meets the ellipsoid.
Vec3d on_ellipsoid(Vec3d p) {
  const double scale =
      std::sqrt((p.x * p.x + p.y * p.y) / (kEquator * kEquator) + p.z * p.z / (kPole * kPole));
  return p * (1 / scale);
}

}  // namespace

bool is_on_globe(Vec3d place) {
  constexpr double kBelow = 15'000, kAbove = 50'000;
  const double distance = length(place);
  return distance >= kPole - kBelow && distance <= kEquator + kAbove;
}

bool is_local_frame(const GltfTransform& t) {
  constexpr double kNearlyUp = 0.99;
  const Vec3d z{t.rows[0].z, t.rows[1].z, t.rows[2].z};
  return is_rigid(t) && is_on_globe(t.offset) && dot(z, up_at(t.offset)) > kNearlyUp;
}

GlobeFrame frame_at(Vec3d place) {
  const Vec3d origin{std::round(place.x), std::round(place.y), std::round(place.z)};
  const Vec3d up = up_at(origin);
  const double from_axis = std::sqrt(origin.x * origin.x + origin.y * origin.y);
  const Vec3d east =
      from_axis > 1 ? Vec3d{-origin.y / from_axis, origin.x / from_axis, 0} : Vec3d{0, 1, 0};
  const Vec3d north = cross(up, east);
  return {
      {{Vec3d{east.x, north.x, up.x}, Vec3d{east.y, north.y, up.y}, Vec3d{east.z, north.z, up.z}},
       origin}};
}

std::optional<GlobeFrame> frame_amid(const std::vector<Vec3d>& places) {
  Vec3d least = places.front(), most = places.front();
  for (const Vec3d& p : places) {
    least = {std::min(least.x, p.x), std::min(least.y, p.y), std::min(least.z, p.z)};
    most = {std::max(most.x, p.x), std::max(most.y, p.y), std::max(most.z, p.z)};
  }
  const Vec3d middle = (least + most) * 0.5;
  if (is_on_globe(middle))
    return frame_at(middle);
  if (length(middle) < kPole / 2)
    return std::nullopt;
  return frame_at(on_ellipsoid(middle));
}

GltfTransform to_frame(const std::optional<GlobeFrame>& frame) {
  GltfTransform turn;
  if (!frame)
    return turn;
  const auto& rows = frame->to_globe.rows;
  for (int i = 0; i < 3; ++i)
    turn.rows[static_cast<std::size_t>(i)] = {rows[0][i], rows[1][i], rows[2][i]};
  turn.offset = transformed(turn, frame->to_globe.offset) * -1.0;
  return turn;
}

Transform GlobeFrame::matrix() const {
  const auto& [rows, offset] = to_globe;
  Transform matrix = kIdentity;
  for (int column = 0; column < 3; ++column) {
    for (std::size_t row = 0; row < 3; ++row)
      matrix[4 * static_cast<std::size_t>(column) + row] = rows[row][column];
  }
  for (int row = 0; row < 3; ++row)
    matrix[12 + static_cast<std::size_t>(row)] = offset[row];
  return matrix;
}

}  // namespace meshhier::mesh_io
