// The part of a stage that one process does.
#pragma once

#include <cstdint>

namespace meshhier::pipeline {

/// Part `index` of `of` equal ones; a build on one machine does all in one.
struct Share {
  std::uint32_t index = 0;
  std::uint32_t of = 1;  ///< >= 1

  /// The share of `count` items in order is [begin(count), end(count)). All shares together are all
  /// items.
  constexpr std::uint64_t begin(std::uint64_t count) const { return count * index / of; }
  constexpr std::uint64_t end(std::uint64_t count) const {
    return count * (std::uint64_t{index} + 1) / of;
  }
};

/// Levels [top, end) of the tree, and the part of each that is to be made.
struct LevelRange {
  int top = 0;
  int end = 0;
  Share share{};
};

}  // namespace meshhier::pipeline
