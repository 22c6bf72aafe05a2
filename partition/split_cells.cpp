#include "partition/split_cells.h"

#include "partition/split_plane.h"

#include <utility>

namespace meshhier::partition {
namespace {

/// A cell is taken to be larger by this on each side, in cells. A point's cell is computed with
/// errors of 10^-7 cells at most, even where the box is a few units in the last place of its
/// coordinates.
constexpr double kMargin = 1e-3;

struct Box {
  Vec3d low, high;

  /// The corner that lies farthest along the direction.
  Vec3d farthest(Vec3d direction) const {
    return {direction.x < 0 ? low.x : high.x, direction.y < 0 ? low.y : high.y,
            direction.z < 0 ? low.z : high.z};
  }
};

}  // namespace

SplitCells::SplitCells(std::vector<Split> splits, const Bounds& box)
    : splits_(std::move(splits)), starts_(kSide * kSide * kSide) {
  for (auto& start : starts_)
    start.store(kUnknown, std::memory_order_relaxed);
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const double low = box.min[axis], extent = box.max[axis] - low;
    // A layer outside on each side. A flat box lies in one layer of cells of size one.
    size_[k] = extent > 0 ? extent / (kSide - 2) : 1;
    scale_[k] = 1 / size_[k];
    origin_[k] = low - size_[k];
  }
}

/// Projections are computed as for points; rounding keeps their order along each axis, so those of
/// the cell's corners bound those of its points.
std::uint32_t SplitCells::look_at(const std::array<std::uint32_t, 3>& cell,
                                  std::atomic<std::uint32_t>& known) const {
  const auto place = [&](std::size_t axis, double at) {
    return origin_[axis] + (cell[axis] + at) * size_[axis];
  };
  const Box box{{place(0, -kMargin), place(1, -kMargin), place(2, -kMargin)},
                {place(0, 1 + kMargin), place(1, 1 + kMargin), place(2, 1 + kMargin)}};
  std::uint32_t node = 0;
  while (node < splits_.size()) {
    const Split& split = splits_[node];
    const auto most = ordered_bits(dot(split.direction, box.farthest(split.direction)));
    const auto least = ordered_bits(dot(split.direction, box.farthest(split.direction * -1.0)));
    if (most < split.low) {
      node = 2 * node + 1;
    } else if (least > split.high) {
      node = 2 * node + 2;
    } else {
      break;
    }
  }
  known.store(node, std::memory_order_relaxed);
  return node;
}

}  // namespace meshhier::partition
