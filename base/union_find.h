// Sets that are joined until the question is only who belongs together.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace meshhier {

/// [0, count) in disjoint sets, each named by its least element, whatever the order of the joins.
class UnionFind {
 public:
  explicit UnionFind(std::uint32_t count) { reset(count); }
  /// All are apart again.
  void reset(std::uint32_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  /// The name of the set that has `v`. O(log n) amortised.
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v)
      v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  /// False if they were one already.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b)
      return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace meshhier
