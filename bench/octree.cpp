// octree_parts(): an adaptive octree with a given number of leaves.
#include "bench/partitioners.h"
#include "hierarchy/bounds.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <queue>
#include <tuple>

namespace meshhier::bench {
namespace {

/// Cells this deep are not cut: 2^-64 of the cube is below what single precision tells apart but
/// next to zero, where points of one cell then count as one.
constexpr int kMostDepth = 64;

struct Cell {
  Vec3d corner;
  double size = 0;
  int depth = 0;
  std::size_t begin = 0;  ///< its points: [begin, end) of the order
  std::size_t end = 0;

  std::size_t points() const { return end - begin; }
};

/// Fewer points come later; of equally many the cell whose points come first in the order.
struct LessUrgent {
  bool operator()(const Cell& a, const Cell& b) const {
    return std::tuple(a.points(), b.begin) < std::tuple(b.points(), a.begin);
  }
};

class Octree {
 public:
  explicit Octree(std::span<const Vec3f> points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    const Bounds bounds = bounds_of(points);
    const Vec3d corner = to_double(bounds.min);
    const Vec3d extent = to_double(bounds.max) - corner;
    put({corner, std::max({extent.x, extent.y, extent.z}), 0, 0, points.size()});
  }

  Parts run(std::uint32_t count) {
    while (leaf_count() < count && !open_.empty()) {
      const Cell cell = open_.top();
      open_.pop();
      cut(cell);
    }
    for (; !open_.empty(); open_.pop())
      closed_.push_back(open_.top());
    std::sort(closed_.begin(), closed_.end(),
              [](const Cell& a, const Cell& b) { return a.begin < b.begin; });
    Parts parts{std::vector<std::uint32_t>(points_.size()),
                static_cast<std::uint32_t>(closed_.size())};
    for (std::uint32_t leaf = 0; leaf < parts.count; ++leaf) {
      for (std::size_t i = closed_[leaf].begin; i < closed_[leaf].end; ++i)
        parts.part_of[order_[i]] = leaf;
    }
    return parts;
  }

 private:
  std::size_t leaf_count() const { return open_.size() + closed_.size(); }

  void put(const Cell& cell) {
    if (cell.points() == 0)
      return;
    if (cell.points() == 1 || cell.depth == kMostDepth)
      closed_.push_back(cell);
    else
      open_.push(cell);
  }

  /// Sorts the cell's points by octant: x is the highest bit.
  void cut(const Cell& cell) {
    const double half = cell.size / 2;
    const Vec3d middle = cell.corner + Vec3d{half, half, half};
    const auto octant = [&](std::uint32_t point) {
      const Vec3d p = to_double(points_[point]);
      return (p.x >= middle.x ? 4U : 0U) + (p.y >= middle.y ? 2U : 0U) + (p.z >= middle.z);
    };
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::array<std::size_t, 9> ends{};
    for (std::size_t i = cell.begin; i < cell.end; ++i)
      ++ends[octant(order_[i]) + 1];
    ends[0] = cell.begin;
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    moved_.resize(cell.points());
    std::array<std::size_t, 9> next = ends;
    for (std::size_t i = cell.begin; i < cell.end; ++i)
      moved_[next[octant(order_[i])]++ - cell.begin] = order_[i];
    std::copy(moved_.begin(), moved_.end(), at(cell.begin));
    for (unsigned o = 0; o < 8; ++o) {
      const Vec3d corner{(o & 4) != 0 ? middle.x : cell.corner.x,
                         (o & 2) != 0 ? middle.y : cell.corner.y,
                         (o & 1) != 0 ? middle.z : cell.corner.z};
      put({corner, half, cell.depth + 1, ends[o], ends[o + 1]});
    }
  }

  std::span<const Vec3f> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> moved_;
  std::priority_queue<Cell, std::vector<Cell>, LessUrgent> open_;
  std::vector<Cell> closed_;
};

}  // namespace

Parts octree_parts(std::span<const Vec3f> points, std::uint32_t count) {
  check_part_count(points.size(), count);
  return Octree(points).run(count);
}

}  // namespace meshhier::bench
