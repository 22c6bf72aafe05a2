// octree_parts(): an adaptive octree with a given number of leaves.
#include "bench/partitioners.h"
#include "hierarchy/bounds.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace meshhier::bench {
namespace {

/// Cuts of an axis, at most: what cells of 2^-21 of the cube hold counts as one point.
constexpr int kMostDepth = 21;

/// The point's path from the root: an octant of three bits each, x the highest.
std::uint64_t path_of(Vec3d from_corner, double cube) {
  constexpr double kCells = 1 << kMostDepth;
  const auto cell = [&](double along) {
    const double place = cube > 0 ? along / cube * kCells : 0;
    return static_cast<std::uint64_t>(std::min(place, kCells - 1));
  };
  const std::uint64_t x = cell(from_corner.x), y = cell(from_corner.y), z = cell(from_corner.z);
  std::uint64_t path = 0;
  for (int bit = kMostDepth - 1; bit >= 0; --bit)
    path = path << 3 | (x >> bit & 1) << 2 | (y >> bit & 1) << 1 | (z >> bit & 1);
  return path;
}

/// Points whose paths agree but for the last `depth_left` octants, as places in the order of paths.
struct Cell {
  std::size_t begin = 0;
  std::size_t end = 0;
  int depth_left = kMostDepth;

  bool can_be_cut() const { return end - begin > 1 && depth_left > 0; }
};

/// The one with the most points is cut next; of equally many, the first.
struct LessUrgent {
  bool operator()(const Cell& a, const Cell& b) const {
    return std::tuple(a.end - a.begin, b.begin) < std::tuple(b.end - b.begin, a.begin);
  }
};

}  // namespace

Parts octree_parts(std::span<const Vec3f> points, std::uint32_t count) {
  check_part_count(points.size(), count);
  const Bounds bounds = bounds_of(points);
  const Vec3d corner = to_double(bounds.min);
  const Vec3d extent = to_double(bounds.max) - corner;
  const double cube = std::max({extent.x, extent.y, extent.z});
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;  // path, point
  for (const Vec3f point : points)
    order.emplace_back(path_of(to_double(point) - corner, cube), order.size());
  std::ranges::sort(order);

  std::priority_queue<Cell, std::vector<Cell>, LessUrgent> open;
  std::vector<Cell> leaves;
  const auto put = [&](const Cell& cell) {
    cell.can_be_cut() ? open.push(cell) : leaves.push_back(cell);
  };
  put({0, order.size()});
  while (open.size() + leaves.size() < count && !open.empty()) {
    Cell rest = open.top();
    open.pop();
    const int depth = rest.depth_left - 1;
    while (rest.begin < rest.end) {
      const auto octant = [&](const auto& entry) { return entry.first >> 3 * depth; };
      const auto end =
          std::ranges::upper_bound(order.begin() + rest.begin, order.begin() + rest.end,
                                   octant(order[rest.begin]), {}, octant);
      const std::size_t next = end - order.begin();
      put({std::exchange(rest.begin, next), next, depth});
    }
  }
  for (; !open.empty(); open.pop())
    leaves.push_back(open.top());
  std::ranges::sort(leaves, {}, &Cell::begin);

  Parts parts{std::vector<std::uint32_t>(points.size()), static_cast<std::uint32_t>(leaves.size())};
  for (std::uint32_t leaf = 0; leaf < parts.count; ++leaf) {
    for (std::size_t i = leaves[leaf].begin; i < leaves[leaf].end; ++i)
      parts.part_of[order[i].second] = leaf;
  }
  return parts;
}

}  // namespace meshhier::bench
