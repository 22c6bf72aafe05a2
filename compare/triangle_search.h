// The distance of points to a set of triangles.
#pragma once

#include "base/triangle_tree.h"
#include "base/vec.h"
#include "base/widest_corner.h"

#include <cstdint>
#include <vector>

namespace meshhier::comparing {

inline double doubled_area(const SurfaceTriangle& triangle) {
  return meshhier::doubled_area(triangle[0], triangle[1], triangle[2]);
}

/// Square of the distance of `point` to the triangle, borders included. A triangle without area is
/// the segment or point that its corners span.
double squared_distance(Vec3d point, const SurfaceTriangle& triangle);

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

  const SurfaceTriangle& operator[](std::uint32_t triangle) const { return triangles_[triangle]; }
  /// All triangles with a corner there, in their order. O(log n) and what it returns.
  std::vector<SurfaceTriangle> around(Vec3f corner) const;

 private:
  std::vector<SurfaceTriangle> triangles_;
  TriangleTree tree_;
  double squared_size_;  ///< of the diagonal of the triangles' box
};

}  // namespace meshhier::comparing
