// The corners of a sector's triangles that belong to its neighbours.
#pragma once

#include "execution/cancel.h"
#include "progressive/level_lists.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::progressive {

/// Holds those of one level in memory: a border has few beside its sector.
class ForeignCorners {
 public:
  ForeignCorners() = default;
  /// `width`: the number of values of each.
  ForeignCorners(const LevelLists& level, std::size_t width);
  /// Returns the memory that this takes, at most.
  static std::uint64_t memory_bytes(const LevelLists& level, std::size_t width);

  std::size_t size() const { return ranks_.size(); }
  std::uint32_t rank(std::size_t number) const { return ranks_[number]; }  ///< ascending
  /// Returns the values of the vertex that stands for it on the level.
  std::span<const float> values(std::size_t number) const {
    return std::span(values_).subspan(places_[number] * width_, width_);
  }
  /// Returns the number of a rank; size() if it is none of them.
  std::size_t find(std::uint32_t rank) const;

 private:
  std::size_t width_ = 0;
  std::vector<std::uint32_t> ranks_;
  std::vector<std::size_t> places_;  ///< in values_
  std::vector<float> values_;
};

}  // namespace meshhier::progressive
