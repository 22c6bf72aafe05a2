#include "render/perspective.h"

#include "base/angle.h"
#include "render/space.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

namespace meshhier::render {
namespace {

/// Nothing is seen that is nearer to the eye, as a part of the target's distance.
constexpr double kNearest = 0.02;
/// How much wider than the picture the frustum is that facets are cut to.
constexpr double kWider = 1.25;
/// An edge whose ends' distances differ by more is halved, if it takes as many pixels.
constexpr double kMostRatio = 1.05, kLongPixels = 8;
constexpr int kMostHalvings = 24;

constexpr double kMargin = 1.08;
/// As a part of the box's diagonal.
constexpr double kLeastDistance = 0.01;
constexpr Vec3d kFirstDirection{0.5, 0.3, 1};

Vec3d corner_of(const BoundsD& box, unsigned corner) {
  return {(corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
          (corner & 4) != 0 ? box.max.z : box.min.z};
}

/// The height of half of the picture at a distance of 1: the tangent of half of kViewAngle.
constexpr double kHalfHeight = 0.41421356237309503;

std::array<HalfSpace, 5> frustum_of(double nearest, const Framing& framing) {
  const double up = kWider * kHalfHeight;
  const double right = up * framing.width / framing.height;
  return {HalfSpace{{0, 0, -1}, -nearest}, HalfSpace{{1, 0, -right}, 0},
          HalfSpace{{-1, 0, -right}, 0}, HalfSpace{{0, 1, -up}, 0}, HalfSpace{{0, -1, -up}, 0}};
}

/// What touches two borders of the picture that face each other along an axis: places along it,
/// each less or plus its depth times the slope.
class BorderPair {
 public:
  explicit BorderPair(double slope) : slope_(slope) {}

  /// `depth`: 0 of rays that are parallel.
  void add(double place, double depth) {
    most_ = std::max(most_, place - slope_ * depth);
    least_ = std::max(least_, -place - slope_ * depth);
  }
  double middle() const { return (most_ - least_) / 2; }
  /// How far forward the camera may go.
  double depth() const { return -(most_ + least_) / (2 * slope_); }

 private:
  double slope_;
  double most_ = -std::numeric_limits<double>::infinity(), least_ = most_;
};

View view_of(const Pose& pose) {
  return {pose.target - pose.position, {0, 1, 0}};
}

/// The size of a pixel at the target.
double pixel_at(const Pose& pose, const Framing& framing) {
  return 2 * length(pose.target - pose.position) * kHalfHeight / framing.height;
}

}  // namespace

Perspective::Perspective(const Pose& pose, const Framing& framing)
    : eye_(pose.position),
      distance_(length(pose.target - pose.position)),
      nearest_(kNearest * distance_),
      pixel_(pixel_at(pose, framing)),
      axes_(axes_of(view_of(pose))),
      camera_(view_of(pose), Vec3d{}, pixel_, framing),
      frustum_(frustum_of(nearest_, framing)) {}

Vec3d Perspective::seen(Vec3d place) const {
  const Vec3d from = place - eye_;
  return {dot(axes_.right, from), dot(axes_.up, from), -dot(axes_.back, from)};
}

Vec3d Perspective::projected(Vec3d seen) const {
  const double scale = distance_ / seen.z;
  return axes_.right * (seen.x * scale) + axes_.up * (seen.y * scale) -
         axes_.back * (distance_ - distance_ * scale);
}

bool Perspective::is_long(const CutCorner& a, const CutCorner& b) const {
  if (std::max(a.place.z, b.place.z) <= kMostRatio * std::min(a.place.z, b.place.z))
    return false;
  const auto on_picture = [&](const Vec3d& p) {
    return Vec3d{p.x, p.y, 0} * (distance_ / (p.z * pixel_));
  };
  return length(on_picture(a.place) - on_picture(b.place)) > kLongPixels;
}

void Perspective::add(std::size_t facet, std::array<CutCorner, 3> corners, int depth,
                      CutFacets& to) const {
  for (std::size_t k = 0; k < 3 && depth < kMostHalvings; ++k) {
    const CutCorner &a = corners[k], &b = corners[(k + 1) % 3], &c = corners[(k + 2) % 3];
    if (!is_long(a, b))
      continue;
    const CutCorner middle = mixed(a, b, 0.5);
    add(facet, {a, middle, c}, depth + 1, to);
    return add(facet, {middle, b, c}, depth + 1, to);
  }
  for (CutCorner& corner : corners)
    corner.place = projected(corner.place);
  to.add(facet, corners[0], corners[1], corners[2]);
}

void Perspective::project(SceneTile& tile) const {
  CutFacets moved(tile);
  for (std::size_t i = 0; i < tile.facets.size(); ++i) {
    CutPolygon polygon = polygon_of(tile, i);
    for (CutCorner& corner : polygon)
      corner.place = seen(corner.place);
    clip(polygon, frustum_);
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
      add(i, {polygon[0], polygon[k], polygon[k + 1]}, 0, moved);
  }
  moved.put();
}

bool Perspective::sees(const BoundsD& box) const {
  return std::ranges::all_of(frustum_, [&](const HalfSpace& side) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      if (side.beyond(seen(corner_of(box, corner))) <= 0)
        return true;
    }
    return false;
  });
}

double Perspective::pixel_in(const BoundsD& box) const {
  double ahead = std::numeric_limits<double>::infinity();
  for (unsigned corner = 0; corner < 8; ++corner)
    ahead = std::min(ahead, seen(corner_of(box, corner)).z);
  return pixel_ * std::max(ahead, nearest_) / distance_;
}

Bounds Perspective::projected(const BoundsD& box) const {
  Bounds all;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3d place = seen(corner_of(box, corner));
    if (place.z < nearest_) {  // it may be anywhere
      const double most = 2 * distance_ / kNearest;
      return {to_float(Vec3d{-most, -most, -most}), to_float(Vec3d{most, most, most})};
    }
    all.add(to_float(projected(place)));
  }
  return all;
}

Camera parallel_camera(const Pose& pose, const Framing& framing) {
  return {view_of(pose), pose.target, pixel_at(pose, framing), framing};
}

ViewAxes parallel_axes(const Pose& pose) {
  return axes_of(view_of(pose));
}

Pose frame_whole(std::span<const Vec3d> points, const BoundsD& box, std::optional<Vec3d> direction,
                 double aspect, Rays rays) {
  const Vec3d ahead = direction.value_or(kFirstDirection) * -1;
  const ViewAxes axes = axes_of({ahead, {0, 1, 0}});
  const double slope = kHalfHeight / kMargin;
  BorderPair sides(slope * aspect), ends(slope);
  const Vec3d centre = (box.min + box.max) * 0.5;
  for (const Vec3d& point : points) {
    const Vec3d from = point - centre;
    const double depth = rays == Rays::parallel ? 0 : -dot(axes.back, from);
    sides.add(dot(axes.right, from), depth);
    ends.add(dot(axes.up, from), depth);
  }
  const double away =
      std::max(-std::min(sides.depth(), ends.depth()), kLeastDistance * length(box.max - box.min));
  const Vec3d target = centre + axes.right * sides.middle() + axes.up * ends.middle();
  return {target + axes.back * (away > 0 ? away : 1), target};
}

std::vector<Vec3d> silhouette_of(std::span<const Vec3d> points) {
  constexpr int kDirections = 256;  // what lies between them sticks out by little
  constexpr double kGoldenAngle = 2.399963229728653, kFullTurn = 6.283185307179586;
  std::set<std::size_t> farthest;
  for (int i = 0; i < kDirections && !points.empty(); ++i) {
    const double z = 1 - (2.0 * i + 1) / kDirections, radius = std::sqrt(1 - z * z);
    const UnitTurn around = turn_by(std::fmod(kGoldenAngle * i, kFullTurn));
    const Vec3d along{radius * around.cosine, radius * around.sine, z};
    std::size_t best = 0;
    for (std::size_t p = 1; p < points.size(); ++p) {
      if (dot(along, points[p]) > dot(along, points[best]))
        best = p;
    }
    farthest.insert(best);
  }
  std::vector<Vec3d> found;
  for (const std::size_t p : farthest)
    found.push_back(points[p]);
  return found;
}

}  // namespace meshhier::render
