// How many vertices simplified tiles are asked to have: the same on all levels, or level by level.
#pragma once

#include "hierarchy/ids.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace meshhier {

/// Vertices of a tile where nobody asks for another number: what a tile costs besides its triangles
/// hardly counts, and one is still fetched and drawn at once.
inline constexpr std::uint32_t kDefaultTileVertices = 8192;

class TargetVertexCounts {
 public:
  /// More than there are levels above the partitions, which are fewer than 2^32.
  static constexpr std::size_t kMostLevels = 32;

  TargetVertexCounts() : TargetVertexCounts(kDefaultTileVertices) {}
  /// So many on all levels. Implicit: one number is what it is in most places.
  TargetVertexCounts(std::uint32_t everywhere) : by_level_{everywhere} {}
  /// From level 0, the root, down; the last one holds for all deeper levels too. Requires one at
  /// least.
  explicit TargetVertexCounts(std::vector<std::uint32_t> by_level)
      : by_level_(std::move(by_level)) {
    assert(!by_level_.empty());
  }

  std::uint32_t of(Level level) const {
    return by_level_[std::min<std::size_t>(raw(level), by_level_.size() - 1)];
  }
  /// Returns the count that a tile of `level` is contracted to if its children have `own_count` > 0
  /// together: the one asked for, but every level is coarser than the one below it by a quarter, or
  /// by a sixteenth where levels were chosen one by one. At least 1.
  std::uint32_t target(Level level, std::uint32_t own_count) const {
    const std::uint64_t most = by_level_.size() == 1 ? std::uint64_t{own_count} * 3 / 4
                                                     : std::uint64_t{own_count} * 15 / 16;
    return std::max(1U, std::min(of(level), static_cast<std::uint32_t>(most)));
  }
  /// The largest count of the levels coarser than `end`; 0 if there are none.
  std::uint32_t largest_above(Level end) const {
    const std::size_t levels = std::min<std::size_t>(raw(end), by_level_.size());
    return levels == 0 ? 0 : *std::max_element(by_level_.begin(), by_level_.begin() + levels);
  }
  /// As given; a single one for all levels.
  std::span<const std::uint32_t> by_level() const { return by_level_; }

  friend bool operator==(const TargetVertexCounts&, const TargetVertexCounts&) = default;

 private:
  std::vector<std::uint32_t> by_level_;
};

}  // namespace meshhier
