// Finds the nearest of many triangles to a point.
//
// Problem. Each texel of each simplified tile asks for its point on the finer surface: a third of
// the time that textures take (decision 034).
//
// Idea. A tree of boxes with four children each, over triangles sorted by halves. Boxes and
// triangles are measured four at a time, and a search leaves out boxes that are farther than what
// it has found:
//
//                   node: 4 boxes                  query point o
//                /     |      |     \              o    +--box 1--+   +--box 2--+
//             leaf   leaf   node   leaf            |    |    x    |   |         |
//             4 tri  4 tri   ...   4 tri           o----|----x    |   |  not    |
//                                                  near | found   |   |  opened |
//                                                       +---------+   +---------+
//
// Two short cuts begin with something near, so that few boxes are nearer: the leaf of the last
// answer (points are asked for side by side), and look_around(), which collects the leaves around a
// small box of points once for all of them.
//
// Invariant. Neither short cut changes an answer: it only makes the first bound smaller. Of equally
// near triangles the lowest number wins, whatever the order of boxes; boxes are compared with a
// margin for the rounding of single precision.
//
// Cost. O(n log n) to build, O(log n) a query for points near the triangles; 42 ns a leaf, 2.3
// leaves a texel.
#pragma once

#include "hierarchy/bounds.h"
#include "hierarchy/four_floats.h"
#include "hierarchy/vec.h"

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
  using Corners = std::array<Vec3f, 3>;

  struct Found {
    std::uint32_t triangle = kNone;
    double on_b = 0, on_c = 0;  ///< a + on_b * (b - a) + on_c * (c - a) is the nearest point
  };
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// Points and triangles are measured from `centre`, in units of `unit`, in single precision.
  /// O(n log n).
  NearestTriangle(const std::vector<Corners>& triangles, const Vec3d& centre, double unit);

  /// Finds the nearest of those that face as `facing` and lie within `reach`, else of all; the one
  /// of the lowest number of equally near ones. O(log n) for points near the triangles.
  Found operator()(const Vec3d& point, const Vec3d& facing, double reach);

  /// Points within the box will be asked for, until the next one: collects what is near it, as near
  /// as the last answers were. What is farther, and other points, are searched for in the tree.
  void look_around(const BoundsD& box);

 private:
  static constexpr std::uint32_t kIsLeaf = std::uint32_t{1} << 31;
  using Four = FourFloats;
  struct Node {
    Four low_x, low_y, low_z, high_x, high_y, high_z;
    std::array<std::uint32_t, 4> children;  ///< nodes, or leaves with kIsLeaf; kNone

    /// The squared distances of the children's boxes from another one.
    [[gnu::always_inline]] Four distances(Four from_x, Four from_y, Four from_z, Four to_x,
                                          Four to_y, Four to_z) const;
  };
  /// Corner a and edges to b and c.
  struct Leaf {
    Four ax, ay, az, bx, by, bz, cx, cy, cz;
    std::array<std::uint32_t, 4> triangles;
  };
  Vec3f moved(const Vec3d& point) const { return to_float((point - centre_) * scale_); }
  struct Query {
    Four x, y, z, facing_x, facing_y, facing_z;
    bool any = false;
    float nearest = std::numeric_limits<float>::infinity();
    std::uint32_t triangle = kNone;
    std::uint32_t leaf = kNone;
  };

  class Builder;
  void measure(std::uint32_t leaf, Query& query) const;
  void search(Query& query) const;
  void add_around(const Node& node, std::size_t child);
  bool is_around(const Vec3f& point) const;
  void measure_around(Query& query) const;

  /// The surface near a box: boxes of leaves, four at a time.
  struct Surroundings {
    Vec3f low, high;
    float reach = 0;  ///< squared: leaves within it are there
    std::vector<Node> leaves;
    std::size_t count = 0;  ///< of leaves

    void clear() {
      leaves.clear();
      count = 0;
    }
  };

  Vec3d centre_;
  double scale_;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::vector<Corners> corners_;  ///< from the centre
  std::uint32_t root_ = kNone;
  std::uint32_t last_leaf_ = kNone;
  Surroundings around_;
  float farthest_ = 0;  ///< of the answers since the last look around, squared
};

}  // namespace meshhier::texture
