#include "render/points.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace meshhier::render {
namespace {

/// The part of a picture's pixels that squares take, if they do not cover each other.
constexpr double kCovered = 0.35;
/// Pixels: smaller ones flicker, larger ones show squares.
constexpr double kLeastSide = 1.5, kMostSide = 6;

}  // namespace

double point_side(const Camera& camera, std::uint64_t count) {
  const double pixels = kCovered * camera.framing().width * camera.framing().height;
  const double side = std::sqrt(pixels / static_cast<double>(std::max<std::uint64_t>(count, 1)));
  return camera.pixel() * std::clamp(side, kLeastSide, kMostSide);
}

std::vector<Facet> squares_of(std::span<const Facet> points, const ViewAxes& axes, double side) {
  const Vec3d right = axes.right * (side / 2), up = axes.up * (side / 2);
  std::vector<Facet> squares;
  squares.reserve(2 * points.size());
  for (const Facet& point : points) {
    const auto corner = [&](Vec3d aside) {
      FacetCorner moved = point[0];
      moved.position = to_float(to_double(moved.position) + aside);
      return moved;
    };
    const std::array<FacetCorner, 4> corners{corner((right + up) * -1), corner(right - up),
                                             corner(right + up), corner(up - right)};
    squares.push_back({corners[0], corners[1], corners[2]});
    squares.push_back({corners[0], corners[2], corners[3]});
  }
  return squares;
}

Bounds box_of_squares(const Bounds& points, double side) {
  if (points.empty())
    return points;
  const Vec3d reach{side, side, side};
  return {to_float(to_double(points.min) - reach), to_float(to_double(points.max) + reach)};
}

}  // namespace meshhier::render
