#include "texture/chart_projection.h"

#include "base/two_doubles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace meshhier::texture {
namespace {

/// Directions that a box may have, over a quarter of a circle.
constexpr int kTurns = 12;

Vec3d mean_normal(const Faces& faces, std::span<const std::uint32_t> chart) {
  Vec3d sum;
  for (const std::uint32_t t : chart)
    sum = sum + faces.normals[t] * faces.areas[t];
  const double size = length(sum);
  return size > 0 ? sum * (1 / size) : Vec3d{0, 0, 1};
}

/// Any two directions with it at right angles.
std::pair<Vec3d, Vec3d> across(const Vec3d& normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  const Vec3d axis = x <= y && x <= z ? Vec3d{1, 0, 0} : y <= z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  const Vec3d other = cross(axis, normal);
  const Vec3d u = other * (1 / length(other));
  return {u, cross(normal, u)};
}

}  // namespace

std::span<const std::uint32_t> ChartVertices::of(std::span<const std::uint32_t> chart) {
  vertices_.resize(std::max(vertices_.size(), 3 * chart.size()));
  ++chart_;
  std::size_t count = 0;
  for (const std::uint32_t t : chart) {
    for (const TileVertex corner : triangles_[t]) {
      vertices_[count] = raw(corner);
      count += std::exchange(chart_of_[raw(corner)], chart_) != chart_ ? 1 : 0;
    }
  }
  return std::span(vertices_).first(count);
}

struct ChartProjector::Box {
  double low_x, low_y, high_x, high_y;
  double width() const { return high_x - low_x; }
  double height() const { return high_y - low_y; }
};

void ChartProjector::place(std::span<const std::uint32_t> vertices, const Vec3d& u,
                           const Vec3d& v) {
  count_ = vertices.size() + vertices.size() % 2;
  x_.resize(std::max(x_.size(), count_));
  y_.resize(x_.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d p = to_double(positions_[vertices[i]]);
    x_[i] = dot(p, u);
    y_[i] = dot(p, v);
  }
  x_[count_ - 1] = x_[vertices.size() - 1];
  y_[count_ - 1] = y_[vertices.size() - 1];
}

ChartProjector::Box ChartProjector::turned_box(double cosine, double sine) const {
  constexpr double kHuge = std::numeric_limits<double>::max();
  TwoDoubles low_x = TwoDoubles{} + kHuge, low_y = low_x, high_x = -low_x, high_y = -low_x;
  for (std::size_t i = 0; i < count_; i += 2) {
    const auto x = load_two(x_.data() + i), y = load_two(y_.data() + i);
    const TwoDoubles to_x = cosine * x + sine * y, to_y = cosine * y - sine * x;
    low_x = smaller_of(low_x, to_x);
    low_y = smaller_of(low_y, to_y);
    high_x = larger_of(high_x, to_x);
    high_y = larger_of(high_y, to_y);
  }
  return {std::min(low_x[0], low_x[1]), std::min(low_y[0], low_y[1]),
          std::max(high_x[0], high_x[1]), std::max(high_y[0], high_y[1])};
}

ChartPlane ChartProjector::operator()(std::span<const std::uint32_t> chart) {
  ChartPlane plane;
  plane.normal = mean_normal(faces_, chart);
  const auto [u, v] = across(plane.normal);
  place(vertices_.of(chart), u, v);
  double least = std::numeric_limits<double>::max();
  for (int turn = 0; turn < kTurns; ++turn) {
    const double half = turn / double(kTurns);  // the tangent of half of the angle
    const double cosine = (1 - half * half) / (1 + half * half);
    const double sine = 2 * half / (1 + half * half);
    const Box box = turned_box(cosine, sine);
    if (const double area = box.width() * box.height(); area < least) {
      least = area;
      plane.x = u * cosine + v * sine;
      plane.y = v * cosine + u * -sine;
      plane.low_x = box.low_x;
      plane.low_y = box.low_y;
      plane.width = box.width();
      plane.height = box.height();
    }
  }
  if (plane.height > plane.width) {  // lying charts pack better: a quarter of a turn
    const Box box = turned_box(dot(plane.y, u), dot(plane.y, v));
    plane = {plane.y, plane.x * -1, plane.normal, box.low_x, box.low_y, box.width(), box.height()};
  }
  return plane;
}

}  // namespace meshhier::texture
