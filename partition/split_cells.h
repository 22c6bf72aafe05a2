// A grid over a tree of splits: where in the tree the way of a point has to be looked at.
//
// On the way down from the root most splits are far off. A cell that lies on one side of a node's
// split as a whole sends all its points there, so that their way begins at the first node whose
// split crosses the cell: one or two levels above its end instead of all.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

namespace meshhier::partition {

/// Thread-safe. Cells are looked at when the first point falls into them.
class SplitCells {
 public:
  /// ordered_bits() of projections along `direction`: below `low` is certainly left, above `high`
  /// certainly right.
  struct Split {
    Vec3d direction;
    std::uint64_t low = 0;
    std::uint64_t high = 0;
  };

  /// `splits`: in heap order, fewer than 2^16. `box`: of about all points.
  SplitCells(std::vector<Split> splits, const Bounds& box);

  /// A node on the way of the point: its ancestors' splits certainly lead there. Nodes from
  /// splits.size() on are leaves.
  std::uint32_t start(Vec3f point) const {
    const double x = (point.x - origin_[0]) * scale_[0];
    const double y = (point.y - origin_[1]) * scale_[1];
    const double z = (point.z - origin_[2]) * scale_[2];
    const auto inside = [](double t) { return t >= 0 && t < kSide; };
    if (!inside(x) || !inside(y) || !inside(z))
      return 0;
    const std::array<std::uint32_t, 3> cell{static_cast<std::uint32_t>(x),
                                            static_cast<std::uint32_t>(y),
                                            static_cast<std::uint32_t>(z)};
    // Relaxed: a number stands alone, and threads that look at a cell at once find the same one.
    std::atomic<std::uint32_t>& known = starts_[(cell[0] * kSide + cell[1]) * kSide + cell[2]];
    const std::uint32_t start = known.load(std::memory_order_relaxed);
    return start != kUnknown ? start : look_at(cell, known);
  }

 private:
  /// Cells along an axis: 1 MiB of them. Chunks are a sixteenth of a large mesh across; half of the
  /// cells on a surface then lie in one chunk.
  static constexpr std::uint32_t kSide = 64;
  static constexpr std::uint32_t kUnknown = ~0u;

  std::uint32_t look_at(const std::array<std::uint32_t, 3>& cell,
                        std::atomic<std::uint32_t>& known) const;

  std::vector<Split> splits_;
  std::array<double, 3> origin_{}, scale_{};  ///< cell = (point - origin) * scale
  std::array<double, 3> size_{};              ///< of a cell
  mutable std::vector<std::atomic<std::uint32_t>> starts_;
};

}  // namespace meshhier::partition
