// Finds the nearest of many triangles to a point.
//
// Problem. Each texel of each simplified tile asks for its point on the finer surface: a third of
// the time that textures take (decision 034).
//
// Idea. A tree of boxes (base/triangle_tree.h) whose leaves hold four triangles, measured at
// the same time. Two short cuts begin with something near, so that few boxes are nearer: the leaf
// of the last answer (points are asked for side by side), and look_around(), which collects the
// leaves around a small box of points once for all of them.
//
// Invariant. Neither short cut changes an answer: it only makes the first bound smaller. Of equally
// near triangles the lowest number wins, whatever the order of boxes.
//
// Cost. O(n log n) to build, O(log n) a query for points near the triangles; 42 ns a leaf, 2.3
// leaves a texel.
#pragma once

#include "base/bounds.h"
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

  /// Points within the box will be asked for, until the next one: collects what is near it, as near
  /// as the last answers were. What is farther, and other points, are searched for in the tree.
  void look_around(const BoundsD& box);

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
  void add_around(const TriangleTree::Node& node, std::size_t child);
  bool is_around(const Vec3f& point) const;
  void measure_around(Asked& asked) const;

  /// The surface near a box: boxes of leaves, four at a time.
  struct Surroundings {
    Vec3f low, high;
    float reach = 0;  ///< squared: leaves within it are there
    std::vector<TriangleTree::Node> leaves;
    std::size_t count = 0;  ///< of leaves

    void clear() {
      leaves.clear();
      count = 0;
    }
  };

  Vec3d centre_;
  double scale_;
  std::vector<SurfaceTriangle> triangles_;  ///< moved
  TriangleTree tree_;
  std::vector<Leaf> leaves_;
  std::uint32_t last_leaf_ = kNone;
  Surroundings around_;
  float farthest_ = 0;  ///< of the answers since the last look around, squared
};

}  // namespace meshhier::texture
