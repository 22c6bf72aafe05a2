#include "compare/triangle_search.h"

#include "base/bounds.h"
#include "base/closest_point.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

namespace meshhier::comparing {
namespace {

/// Each triangle has a box of its own: to measure it exactly takes as long as many boxes.
constexpr std::size_t kLeafSize = 1;

/// A box of single precision that has the point in it.
TriangleTree::Query around(Vec3d point) {
  const Vec3f near = to_float(point);
  const auto slack = [](float x) { return std::abs(x) * 0x1p-22F; };
  const Vec3f margin{slack(near.x), slack(near.y), slack(near.z)};
  return {near - margin, near + margin};
}

/// No less than a squared distance, in single precision; nothing is nearer than 0.
float reach_of(double squared) {
  using Float = std::numeric_limits<float>;
  if (squared > Float::max())
    return Float::infinity();
  return squared > 0 ? static_cast<float>(squared) + Float::min() : -1;
}

Bounds box_of(std::span<const SurfaceTriangle> triangles) {
  Bounds box;
  for (const SurfaceTriangle& triangle : triangles) {
    for (const Vec3f corner : triangle)
      box.add(corner);
  }
  return box;
}

/// Returns whether a triangle lies beyond the plane across the way to its first corner, as far
/// along it as `squared` says: then no point of it is nearer. The box of a triangle that is aslant
/// is nearer than the triangle, by its size; from far away that plane is hardly. What is rounded
/// off is a fraction of what with_rounding() adds.
bool is_beyond(Vec3d point, const SurfaceTriangle& triangle, double squared) {
  const Vec3d way = to_double(triangle[0]) - point;
  const double along = std::min({dot(way, way), dot(way, to_double(triangle[1]) - point),
                                 dot(way, to_double(triangle[2]) - point)});
  return along > 0 && along * along > squared * dot(way, way);
}

/// Boxes so large, squared, are told apart by floats, with room for farther points.
bool suits_floats(double squared) {
  return squared > 0x1p-80 && squared < 0x1p100;
}

}  // namespace

double squared_diagonal(const Bounds& box) {
  const Vec3d size = box.empty() ? Vec3d{} : to_double(box.max) - to_double(box.min);
  return dot(size, size);
}

double squared_distance(Vec3d point, const SurfaceTriangle& triangle) {
  const auto [a, b, c] = widest_first(triangle[0], triangle[1], triangle[2]);
  return squared_distance(point, TriangleFrame(a, b, c));
}

TriangleSearch::TriangleSearch(std::vector<SurfaceTriangle> triangles)
    : triangles_(std::move(triangles)),
      tree_(triangles_, kLeafSize),
      squared_size_(squared_diagonal(box_of(triangles_))) {}

std::uint64_t TriangleSearch::memory_bytes() const {
  return sizeof *this + size() * sizeof(SurfaceTriangle) + tree_.memory_bytes();
}

/// A squared distance beyond which no box is looked into; below 0: none is at all.
struct TriangleSearch::Reach {
  double squared;
  float rounded;

  explicit Reach(double within) : squared(within), rounded(reach_of(within)) {}
};

/// Calls offer(triangle) for those whose boxes are in reach, which it may lower.
template <class Offer>
void TriangleSearch::look_within(Vec3d point, const Reach& reach, const Offer& offer) const {
  const auto look = [&](std::uint32_t leaf) { offer(tree_.triangles(leaf).front()); };
  if (suits_floats(squared_size_) && reach.squared < kFarInSizes * squared_size_)
    tree_.look_nearest(comparing::around(point), reach.rounded, look);
  else
    tree_.look_nearest(point, reach.squared, look);
}

double TriangleSearch::nearest(Vec3d point, double limit, std::uint32_t& hint) const {
  if (triangles_.empty())
    return limit;
  Reach reach(limit);
  const auto offer = [&](std::uint32_t triangle) {
    const double squared = squared_distance(point, triangles_[triangle]);
    if (squared < limit) {
      limit = squared;
      reach = Reach(squared);
      hint = triangle;
    }
  };
  offer(hint);
  if (limit > 0)
    look_within(point, reach, offer);
  return limit;
}

NearTriangle TriangleSearch::first_nearest(Vec3d point, double limit, std::uint32_t hint) const {
  NearTriangle best{limit, TriangleTree::kNone};
  if (triangles_.empty())
    return {};
  Reach reach(with_rounding(limit, squared_size_));
  const auto offer = [&](std::uint32_t triangle) {
    if (is_beyond(point, triangles_[triangle], reach.squared))
      return;
    const double squared = squared_distance(point, triangles_[triangle]);
    if (squared < best.squared)
      reach = Reach(with_rounding(squared, squared_size_));
    if (squared < best.squared || (squared == best.squared && triangle < best.triangle))
      best = {squared, triangle};
  };
  offer(hint);
  look_within(point, reach, offer);
  return best.triangle == TriangleTree::kNone ? NearTriangle{} : best;
}

HitTriangle TriangleSearch::first_hit(const Ray& ray, double limit) const {
  HitTriangle best{limit, TriangleTree::kNone};
  tree_.look_nearest(ray, best.distance, [&](std::uint32_t leaf) {
    const std::uint32_t triangle = tree_.triangles(leaf).front();
    const auto& [a, b, c] = triangles_[triangle];
    const auto distance = ray.hit(a, b, c);
    if (distance &&
        (*distance < best.distance || (*distance == best.distance && triangle < best.triangle)))
      best = {*distance, triangle};
  });
  return best.triangle == TriangleTree::kNone ? HitTriangle{} : best;
}

std::vector<SurfaceTriangle> TriangleSearch::around(Vec3f corner) const {
  std::vector<std::uint32_t> found;
  tree_.take_within(TriangleTree::Query(corner), 0,
                    [&](const TriangleTree::Node& node, std::size_t child) {
                      const std::uint32_t triangle = tree_.triangles(node.leaf(child)).front();
                      if (std::ranges::count(triangles_[triangle], corner) > 0)
                        found.push_back(triangle);
                      return true;
                    });
  std::ranges::sort(found);
  std::vector<SurfaceTriangle> triangles;
  triangles.reserve(found.size());
  for (const std::uint32_t triangle : found)
    triangles.push_back(triangles_[triangle]);
  return triangles;
}

}  // namespace meshhier::comparing
