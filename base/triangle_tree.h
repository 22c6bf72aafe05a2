// A tree of boxes over triangles, for whoever asks which of them are near.
//
// Problem. Textures are baked from the nearest points of a finer surface, one a texel; distances
// between surfaces are those of many points to the nearest triangle; rays ask what they hit first.
// All want to look at few of the triangles, but measure them in ways of their own: quick and facing
// alike, or exact.
//
// Idea. Each node has four children and measures their boxes in one go. The tree decides which
// leaves are looked at, nearest boxes first; the caller measures what a leaf holds and lowers the
// reach as it finds something:
//
//                   node: 4 boxes                  query o
//                /     |      |     \              o    +--box 1--+   +--box 2--+
//             leaf   leaf   node   leaf            |    |    x    |   |         |
//                            ...                   o----|----x    |   |  not    |
//                                                  near | found   |   |  opened |
//                                                       +---------+   +---------+
//
// Invariant. A leaf is left out only if its box is farther than the reach by more than single
// precision rounds. A query is a box: for a point in double precision, one that holds it.
//
// Cost. O(n log n) to build, O(log n) a query near the triangles; 28 bytes for a child of a node.
#pragma once

#include "base/four_floats.h"
#include "base/ray.h"
#include "base/vec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier {

/// The corners of a triangle in space; may have no area.
using SurfaceTriangle = std::array<Vec3f, 3>;

/// Immutable; thread-safe. Holds numbers and boxes, not the triangles.
class TriangleTree {
 public:
  using Four = FourFloats;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::uint32_t kIsLeaf = std::uint32_t{1} << 31;

  /// A box that is asked about, in all four lanes.
  struct Query {
    Four low_x, low_y, low_z, high_x, high_y, high_z;

    Query(const Vec3f& low, const Vec3f& high)
        : low_x(Four{} + low.x),
          low_y(Four{} + low.y),
          low_z(Four{} + low.z),
          high_x(Four{} + high.x),
          high_y(Four{} + high.y),
          high_z(Four{} + high.z) {}
    explicit Query(const Vec3f& point) : Query(point, point) {}
  };

  struct Node {
    Four low_x, low_y, low_z, high_x, high_y, high_z;
    std::array<std::uint32_t, 4> children;  ///< nodes, or leaves with kIsLeaf; kNone

    /// The squared distances of the children's boxes from the one that is asked about.
    [[gnu::always_inline]] Four distances(const Query& to) const {
      const auto apart = [](Four low, Four high, Four from, Four end) {
        const Four below = low - end, above = from - high;
        const Four outside = below > above ? below : above;
        return outside > 0.0f ? outside : Four{};
      };
      const Four x = apart(low_x, high_x, to.low_x, to.high_x);
      const Four y = apart(low_y, high_y, to.low_y, to.high_y);
      const Four z = apart(low_z, high_z, to.low_z, to.high_z);
      return x * x + y * y + z * z;
    }
    /// Likewise, of a point in double precision.
    std::array<double, 4> distances(const Vec3d& to) const {
      std::array<double, 4> squared{};
      for (std::size_t k = 0; k < 4; ++k) {
        const double x = std::max({low_x[k] - to.x, 0.0, to.x - high_x[k]});
        const double y = std::max({low_y[k] - to.y, 0.0, to.y - high_y[k]});
        const double z = std::max({low_z[k] - to.z, 0.0, to.z - high_z[k]});
        squared[k] = x * x + y * y + z * z;
      }
      return squared;
    }
    /// Returns how far along a ray each child's box begins, no less than 0; infinite if it misses
    /// it.
    std::array<double, 4> distances(const Ray& ray) const {
      std::array<double, 4> entries{};
      for (std::size_t k = 0; k < 4; k += 2) {
        const auto two = [k](const Four& four) { return TwoDoubles{four[k], four[k + 1]}; };
        const auto span = ray.span_in<TwoDoubles>({two(low_x), two(low_y), two(low_z)},
                                                  {two(high_x), two(high_y), two(high_z)});
        const TwoDoubles entry = span.entry > 0.0 ? span.entry : TwoDoubles{};
        const auto is_empty = span.is_empty();
        for (std::size_t i = 0; i < 2; ++i)
          entries[k + i] = is_empty[i] ? std::numeric_limits<double>::infinity() : entry[i];
      }
      return entries;
    }
    bool is_leaf(std::size_t child) const { return (children[child] & kIsLeaf) != 0; }
    /// Requires is_leaf().
    std::uint32_t leaf(std::size_t child) const { return children[child] & ~kIsLeaf; }
  };

  /// Halves the triangles by their middles along the longest axis, twice for each node, until at
  /// most `leaf_size` are left. Fewer than 2^31 triangles.
  TriangleTree(std::span<const SurfaceTriangle> triangles, std::size_t leaf_size);

  std::size_t leaf_count() const { return (order_.size() + leaf_size_ - 1) / leaf_size_; }
  /// The numbers of a leaf's triangles, 1 to the leaf size.
  std::span<const std::uint32_t> triangles(std::uint32_t leaf) const {
    const std::size_t first = leaf * leaf_size_;
    return std::span(order_).subspan(first, std::min(leaf_size_, order_.size() - first));
  }
  std::uint64_t memory_bytes() const {
    return nodes_.size() * sizeof(Node) + order_.size() * sizeof order_[0];
  }

  /// Calls look(leaf) for each leaf whose box is no farther than `reach`, a squared distance that
  /// `look` may lower; of a node's children the nearest first. `to`: a Query with a float, or a
  /// Vec3d with a double: slower, but it tells boxes apart however far, tiny or huge they are; or a
  /// Ray with a double, for boxes on it, whose distances are along it and not squared, and finite.
  template <class To, class Real, class Look>
  void look_nearest(const To& to, const Real& reach, const Look& look) const {
    struct Open {
      Real distance;
      std::uint32_t name;
    };
    std::array<Open, kMostOpen> open;
    std::size_t count = nodes_.empty() ? 0 : 1;
    open[0] = {0, kRoot};
    while (count > 0) {
      const Open next = open[--count];
      if (next.distance > reach * kRounding<Real>)
        continue;
      if ((next.name & kIsLeaf) != 0) {
        look(next.name & ~kIsLeaf);
        continue;
      }
      const Node& node = nodes_[next.name];
      const auto distance = node.distances(to);
      const std::size_t first = count;
      for (std::size_t k = 0; k < 4; ++k) {
        if (node.children[k] == kNone || distance[k] > reach * kRounding<Real>)
          continue;
        std::size_t place = count++;
        for (; place > first && open[place - 1].distance < distance[k]; --place)
          open[place] = open[place - 1];
        open[place] = {distance[k], node.children[k]};
      }
    }
  }

  /// Calls take(node, child) for each leaf whose box is no farther than `reach`, a squared
  /// distance, until it returns false. Returns false if `take` did.
  template <class Take>
  bool take_within(const Query& query, float reach, const Take& take) const {
    std::array<std::uint32_t, kMostOpen> open;
    std::size_t count = nodes_.empty() ? 0 : 1;
    open[0] = kRoot;
    while (count > 0) {
      const Node& node = nodes_[open[--count]];
      const Four distance = node.distances(query);
      for (std::size_t k = 0; k < 4; ++k) {
        if (node.children[k] == kNone || distance[k] > reach * kRounding<float>)
          continue;
        if (!node.is_leaf(k))
          open[count++] = node.children[k];
        else if (!take(node, k))
          return false;
      }
    }
    return true;
  }

  /// Distances are rounded: boxes that are hardly too far are looked into.
  template <class Real>
  static constexpr Real kRounding = sizeof(Real) == sizeof(float) ? Real(1.00001f)
                                                                  : Real(1 + 1e-12);

 private:
  static constexpr std::uint32_t kRoot = 0;
  /// Three of each of sixteen levels wait, and four of the last one.
  static constexpr std::size_t kMostOpen = 128;

  class Builder;

  std::size_t leaf_size_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  ///< triangles, leaf by leaf; all but the last leaf are full
};

}  // namespace meshhier
