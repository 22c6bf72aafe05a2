#include "partition/direction.h"

#include "base/bounds.h"
#include "partition/eigenvectors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace meshhier::partition {
namespace {

// The band around the median in which point density is measured, as a part of all points. Narrow
// enough to see the cut, wide enough that 256 points hold a dozen of the 5 % band.
constexpr double kBand = 0.05;

// A direction is judged by so many points: the band then holds 800, and what a direction measures
// is good to a few per cent, less than what it leaves out (the slant of the surface). With all
// points, 524,288 of them, planning takes as long as all splits inside the chunks.
constexpr std::size_t kJudgedPoints = 16384;

/// Every so many-th point: more than half of kJudgedPoints, or all.
std::vector<Vec3f> choice_of(std::span<const Vec3f> points) {
  const std::size_t stride = points.size() / (kJudgedPoints + 1) + 1;
  std::vector<Vec3f> chosen;
  chosen.reserve(points.size() / stride + 1);
  for (std::size_t i = 0; i < points.size(); i += stride)
    chosen.push_back(points[i]);
  return chosen;
}

Vec3d unit_axis(int axis) {
  return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
}

Vec3d longest_axis(std::span<const Vec3f> points) {
  const Bounds bounds = bounds_of(points);
  const Vec3d size = to_double(bounds.max) - to_double(bounds.min);
  if (size.x >= size.y && size.x >= size.z)
    return unit_axis(0);
  return unit_axis(size.y >= size.z ? 1 : 2);
}

/// Eigenvectors of the points' covariance.
std::array<Vec3d, 3> principal_axes(std::span<const Vec3f> points) {
  Vec3d mean;
  for (const Vec3f& p : points)
    mean = mean + to_double(p);
  mean = mean * (1.0 / static_cast<double>(points.size()));
  Matrix3 covariance{};
  for (const Vec3f& p : points) {
    const Vec3d d = to_double(p) - mean;
    const std::array<double, 3> from_mean{d.x, d.y, d.z};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        covariance[i][j] += from_mean[i] * from_mean[j];
    }
  }
  // Scaled to about one, so that very small and very large models keep their digits.
  const double scale = covariance[0][0] + covariance[1][1] + covariance[2][2];
  if (!(scale > 0) || !std::isfinite(scale))
    return {unit_axis(0), unit_axis(1), unit_axis(2)};
  for (std::array<double, 3>& row : covariance) {
    for (double& entry : row)
      entry /= scale;
  }
  return eigenvectors(covariance);
}

std::vector<double> projections(std::span<const Vec3f> points, Vec3d direction) {
  std::vector<double> values(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    values[i] = dot(direction, to_double(points[i]));
  return values;
}

double quantile(std::vector<double>& values, double fraction) {
  const auto last = static_cast<double>(values.size() - 1);
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(std::clamp(fraction, 0.0, 1.0) * last);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

std::vector<Vec3d> candidate_directions(std::span<const Vec3f> points, Axis axis) {
  if (axis == Axis::longest || points.size() < 2)
    return {longest_axis(points)};
  std::vector<Vec3d> candidates;
  for (int k = 0; k < 3; ++k)
    candidates.push_back(unit_axis(k));
  for (int k = 0; k < 3; ++k) {
    const Vec3d a = unit_axis(k) * std::sqrt(0.5);
    const Vec3d b = unit_axis((k + 1) % 3) * std::sqrt(0.5);
    candidates.push_back(a + b);
    candidates.push_back(a - b);
  }
  for (const Vec3d& principal : principal_axes(choice_of(points)))
    candidates.push_back(principal);
  return candidates;
}

Vec3d thinnest_direction(std::span<const Vec3f> points, double fraction,
                         std::span<const Vec3d> candidates) {
  if (candidates.size() == 1)
    return candidates[0];
  const std::vector<Vec3f> judged = choice_of(points);
  Vec3d best = candidates[0];
  double best_width = -1;
  for (const Vec3d& direction : candidates) {
    std::vector<double> values = projections(judged, direction);
    const double width =
        (quantile(values, fraction + kBand / 2) - quantile(values, fraction - kBand / 2)) /
        std::max(length(direction), std::numeric_limits<double>::min());
    if (width > best_width) {
      best_width = width;
      best = direction;
    }
  }
  return best;
}

}  // namespace meshhier::partition
