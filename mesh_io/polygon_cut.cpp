#include "mesh_io/polygon_cut.h"

#include "mesh_io/polygon_cover.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// The area's vector, twice (Newell's method), about the first corner.
Vec3d doubled_area(std::span<const Vec3d> corners) {
  Vec3d sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum = sum + cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return sum;
}

/// The axis along which an area is seen largest.
int widest_axis(const Vec3d& area) {
  const double x = std::abs(area.x), y = std::abs(area.y), z = std::abs(area.z);
  return z >= x && z >= y ? 2 : y >= x ? 1 : 0;
}

}  // namespace

PolygonCut::Kind PolygonCut::cut(std::span<const Vec3d> corners) {
  if (!project(corners) || is_fan())
    return Kind::fan;
  const bool is_cut = points_.size() <= kMostEars ? cut_ears() : cut_many();
  return is_cut ? Kind::cut : Kind::crossed;
}

bool PolygonCut::cut_many() {
  auto triangles = cover_polygon(points_, sign_);
  if (triangles)
    triangles_ = *std::move(triangles);
  return triangles.has_value();
}

std::string PolygonCut::limit_text() {
  return fmt::format(
      "expected faces of at most {} corners, found a larger one; cut it into several",
      kMostCorners);
}

/// Projects the corners; returns false if the polygon has no area.
bool PolygonCut::project(std::span<const Vec3d> corners) {
  const Vec3d area = doubled_area(corners);
  const int axis = widest_axis(area);
  if (!std::isfinite(area[axis]) || area[axis] == 0)
    return false;
  sign_ = area[axis] > 0 ? 1 : -1;
  points_.clear();
  for (const Vec3d& p : corners)
    points_.push_back({p[(axis + 1) % 3], p[(axis + 2) % 3]});
  return true;
}

/// Returns whether the fan covers the polygon: triangles that all turn as the polygon does do not
/// cover each other.
bool PolygonCut::is_fan() const {
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    if (turn(0, i, i + 1) < 0)
      return false;
  }
  return true;
}

/// Returns whether the corner turns as the polygon does, and its triangle with its neighbours is
/// free of other corners. Corners at the places of these three do not count: polygons around holes
/// have such ones.
bool PolygonCut::is_ear(std::size_t place) const {
  const std::size_t n = left_.size();
  const std::uint32_t a = left_[(place + n - 1) % n], b = left_[place], c = left_[(place + 1) % n];
  if (turn(a, b, c) <= 0)
    return false;
  return std::ranges::none_of(left_, [&](std::uint32_t p) {
    if (points_[p] == points_[a] || points_[p] == points_[b] || points_[p] == points_[c])
      return false;
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
  });
}

void PolygonCut::look_at(std::size_t place) {
  ears_[left_[place]] = static_cast<char>(is_ear(place));
}

/// Returns the place of the next ear; the count of corners that are left if there is none. A cut
/// may make an ear of a corner far from it, so all are looked at again when no ear is known.
std::size_t PolygonCut::find_ear() {
  const auto find = [&] {
    return static_cast<std::size_t>(
        std::ranges::find_if(left_, [&](std::uint32_t p) { return ears_[p] != 0; }) -
        left_.begin());
  };
  const std::size_t known = find();
  if (known < left_.size())
    return known;
  for (std::size_t place = 0; place < left_.size(); ++place)
    look_at(place);
  return find();
}

/// Returns the place of a corner on a line with its neighbours, or where one of these is: its
/// triangle has no area, so it waits until there is no ear. The count of corners that are left if
/// there is none.
std::size_t PolygonCut::find_flat() const {
  const std::size_t n = left_.size();
  std::size_t place = 0;
  while (place < n && turn(left_[(place + n - 1) % n], left_[place], left_[(place + 1) % n]) != 0)
    ++place;
  return place;
}

void PolygonCut::cut_off(std::size_t place) {
  const std::size_t n = left_.size();
  triangles_.push_back({left_[(place + n - 1) % n], left_[place], left_[(place + 1) % n]});
  left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(place));
  // Only these two have another triangle now; that others lie in one may have changed, which
  // find_ear() looks at when it must.
  look_at((place + n - 2) % (n - 1));
  look_at(place % (n - 1));
}

bool PolygonCut::cut_ears() {
  triangles_.clear();
  ears_.assign(points_.size(), 0);
  left_.resize(points_.size());
  std::iota(left_.begin(), left_.end(), 0U);
  while (left_.size() > 3) {
    std::size_t place = find_ear();
    if (place == left_.size())
      place = find_flat();
    // Without either nothing can be cut off: the polygon crosses itself.
    if (place == left_.size())
      return false;
    cut_off(place);
  }
  triangles_.push_back({left_[0], left_[1], left_[2]});
  return turn(left_[0], left_[1], left_[2]) >= 0;
}

}  // namespace meshhier::mesh_io
