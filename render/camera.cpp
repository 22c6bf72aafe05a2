#include "render/camera.h"

#include "render/space.h"

#include <algorithm>
#include <cmath>

namespace meshhier::render {
namespace {

/// The axis of space along which `direction` goes least.
Vec3d least_axis(Vec3d direction) {
  const double x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
  if (y <= x && y <= z)
    return {0, 1, 0};
  return z <= x ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
}

/// How far a box of that size reaches along an axis.
double extent(Vec3d size, Vec3d axis) {
  return size.x * std::abs(axis.x) + size.y * std::abs(axis.y) + size.z * std::abs(axis.z);
}

/// Samples a unit so that `extent` takes `samples` of them; 0: any number will do.
double scale_for(double extent, double samples) {
  return extent > 0 ? samples / extent : 0;
}

}  // namespace

ViewAxes axes_of(const View& view) {
  /// Below, the direction of a cross product is rounding.
  constexpr double kParallel = 1e-6;
  const Vec3d ahead = unit(view.direction);
  const double size = length(view.up);
  Vec3d right = size > 0 ? cross(ahead, view.up * (1 / size)) : Vec3d{};
  if (!(length(right) > kParallel))
    right = cross(ahead, least_axis(ahead));
  right = unit(right);
  return {right, cross(right, ahead), ahead * -1};
}

ViewExtent extent_of(const BoundsD& box, const ViewAxes& axes) {
  const Vec3d size = box.max - box.min;
  return {extent(size, axes.right), extent(size, axes.up)};
}

Camera::Camera(const View& view, Vec3d centre, double pixel, const Framing& framing)
    : framing_(framing), axes_(axes_of(view)), centre_(centre), scale_(framing.samples / pixel) {}

Camera::Camera(const View& view, const BoundsD& box, const Framing& framing)
    : framing_(framing), axes_(axes_of(view)), centre_((box.min + box.max) * 0.5) {
  const auto [wide, high] = extent_of(box, axes_);
  const double free = 2 * framing.margin * std::min(columns(), rows());
  const double across = scale_for(wide, columns() - free);
  const double upright = scale_for(high, rows() - free);
  if (across > 0 && upright > 0)
    scale_ = std::min(across, upright);
  else if (across > 0 || upright > 0)
    scale_ = std::max(across, upright);
}

Camera Camera::with(const Framing& framing) const {
  Camera other = *this;
  other.framing_ = framing;
  other.scale_ = scale_ * other.rows() / rows();
  return other;
}

}  // namespace meshhier::render
