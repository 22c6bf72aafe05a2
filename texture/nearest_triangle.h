// Finds the nearest of many triangles to a point.
//
// Idea. A tree of boxes (base/triangle_tree.h) whose leaves hold four triangles, measured at
// the same time. A search begins with the leaf of the last answer, so that few boxes are nearer:
// points are asked for side by side.
//
// Invariant. That changes no answer: it only makes the first bound smaller. Of equally near
// triangles the lowest number wins, whatever the order of boxes.
//
// Cost. O(n log n) to build, O(log n) a query for points near the triangles; 42 ns a leaf, 2.3
// leaves a texel.
#pragma once

#include "base/four_floats.h"
#include "base/triangle_tree.h"
#include "base/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::texture {

/// A tree over triangles, and what it remembers from one query to the next: for one thread.
class NearestTriangle {
 public:
  struct Found {
    std::uint32_t triangle = kNone;
    double on_b = 0, on_c = 0;  ///< a + on_b * (b - a) + on_c * (c - a) is the nearest point
  };
  static constexpr std::uint32_t kNone = TriangleTree::kNone;

  /// Points and triangles are measured from `centre`, in units of `unit`, in single precision.
  /// O(n log n).
  NearestTriangle(std::span<const SurfaceTriangle> triangles, const Vec3d& centre, double unit);

  /// Finds the nearest of those that face as `facing` and lie within `reach`, else of all; the one
  /// of the lowest number of equally near ones. O(log n) for points near the triangles.
  Found operator()(const Vec3d& point, const Vec3d& facing, double reach);

 private:
  using Four = FourFloats;
  /// Corner a and edges to b and c.
  struct Leaf {
    Four ax, ay, az, bx, by, bz, cx, cy, cz;
    std::array<std::uint32_t, 4> triangles;
  };
  struct Asked {
    TriangleTree::Query at;
    Four facing_x, facing_y, facing_z;
    bool any = false;
    float nearest = std::numeric_limits<float>::infinity();
    std::uint32_t triangle = kNone;
    std::uint32_t leaf = kNone;
  };

  Vec3f moved(const Vec3d& point) const { return to_float((point - centre_) * scale_); }
  std::vector<SurfaceTriangle> moved(std::span<const SurfaceTriangle> triangles) const;
  Leaf leaf_of(std::span<const std::uint32_t> triangles) const;
  void measure(std::uint32_t leaf, Asked& asked) const;
  void search(Asked& asked) const;

  Vec3d centre_;
  double scale_;
  std::vector<SurfaceTriangle> triangles_;  ///< moved
  TriangleTree tree_;
  std::vector<Leaf> leaves_;
  std::uint32_t last_leaf_ = kNone;
};

}  // namespace meshhier::texture
