// The distance of points to a set of triangles.
#pragma once

#include "base/bounds.h"
#include "base/ray.h"
#include "base/triangle_tree.h"
#include "base/vec.h"
#include "base/widest_corner.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace meshhier::comparing {

inline double doubled_area(const SurfaceTriangle& triangle) {
  return meshhier::doubled_area(triangle[0], triangle[1], triangle[2]);
}

/// Square of the distance of `point` to the triangle, borders included. A triangle without area is
/// the segment or point that its corners span.
double squared_distance(Vec3d point, const SurfaceTriangle& triangle);

/// Boxes are told apart in single precision at distances of up to so many sizes, squared.
inline constexpr double kFarInSizes = 0x1p16;

/// Returns a squared distance within which boxes lie whose triangles may measure no more than
/// `squared`: what squared_distance() rounds off is less than 2^-46 of the size of the triangles,
/// and of what is measured. `squared_size`: of the diagonal of a box around all.
constexpr double with_rounding(double squared, double squared_size) {
  // (d + e)^2 <= d^2 (1 + 2^-20) + e^2 (1 + 2^20). From far away, 2^-20 of the distance would be as
  // large as all triangles; the size is little beside it: (d + e)^2 <= d^2 (1 + 2^-44).
  const double part = squared < kFarInSizes * squared_size ? 0x1p-20 : 0x1p-40;
  return squared * (1 + part) + squared_size * 0x1p-71;
}
/// Returns the squared diagonal of a box; 0 if it is empty.
double squared_diagonal(const Bounds& box);

struct NearTriangle {
  double squared = std::numeric_limits<double>::infinity();  ///< of the distance
  std::uint32_t triangle = TriangleTree::kNone;
};

/// A distance along a ray that is behind all that it can hit.
inline constexpr double kBehindAll = 0x1p1000;

/// The triangle that a ray hits first.
struct HitTriangle {
  double distance = kBehindAll;  ///< along the ray
  std::uint32_t triangle = TriangleTree::kNone;
};

/// Triangles in a tree. Immutable; thread-safe.
class TriangleSearch {
 public:
  /// O(n log n). Fewer than 2^31 triangles.
  explicit TriangleSearch(std::vector<SurfaceTriangle> triangles);

  std::size_t size() const { return triangles_.size(); }
  /// About what it holds in memory.
  std::uint64_t memory_bytes() const;

  /// The smaller of `limit` and the square of the distance of `point` to the nearest triangle.
  /// `hint`: a triangle probably near, < size(), or anything if there are none; becomes the nearest
  /// one if it is nearer than the limit. The distance does not depend on the hint, but the time
  /// does (O(log n) with a good one), and which of equally near triangles is named.
  double nearest(Vec3d point, double limit, std::uint32_t& hint) const;
  /// Returns the first of the triangles that are nearest by squared_distance(), or none if all are
  /// farther than `limit`, squared. `hint`: as above; shows in the time alone.
  NearTriangle first_nearest(Vec3d point, double limit, std::uint32_t hint) const;
  /// Returns the first of the triangles that Ray::hit() finds nearest, or none if all are missed or
  /// farther than `limit`, which is at most kBehindAll.
  HitTriangle first_hit(const Ray& ray, double limit) const;

  const SurfaceTriangle& operator[](std::uint32_t triangle) const { return triangles_[triangle]; }
  /// All triangles with a corner there, in their order. O(log n) and what it returns.
  std::vector<SurfaceTriangle> around(Vec3f corner) const;

 private:
  struct Reach;
  template <class Offer>
  void look_within(Vec3d point, const Reach& reach, const Offer& offer) const;

  std::vector<SurfaceTriangle> triangles_;
  TriangleTree tree_;
  double squared_size_;  ///< of the diagonal of the triangles' box
};

}  // namespace meshhier::comparing
