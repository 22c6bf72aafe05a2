// Triangles, each once.
#pragma once

#include "hierarchy/tile_mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace meshhier::texture {

/// In the order of their first appearance.
class DistinctTriangles {
 public:
  explicit DistinctTriangles(std::span<const TileTriangle> all) : number_(all.size()) {
    const std::vector<std::uint32_t> order = sorted(all);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool again = i > 0 && all[order[i]] == all[order[i - 1]];
      number_[order[i]] = again ? number_[order[i - 1]] : order[i];
    }
    for (std::uint32_t t = 0; t < all.size(); ++t) {
      if (number_[t] == t) {
        number_[t] = static_cast<std::uint32_t>(triangles_.size());
        firsts_.push_back(t);
        triangles_.push_back(all[t]);
      } else {
        number_[t] = number_[number_[t]];  // of the first, which came before
      }
    }
  }
  std::span<const TileTriangle> triangles() const { return triangles_; }
  /// For each of them, its number among all triangles, where it comes first.
  std::span<const std::uint32_t> firsts() const { return firsts_; }
  /// Returns an entry for each triangle, from one for each distinct one.
  template <class T>
  std::vector<T> expanded(const std::vector<T>& of_distinct) const {
    std::vector<T> all;
    all.reserve(number_.size());
    for (const std::uint32_t number : number_)
      all.push_back(of_distinct[number]);
    return all;
  }

 private:
  /// Equal ones in their order. A tile's triangles come sorted, those inside it and those at its
  /// border: two sequences, which only need to be merged.
  static std::vector<std::uint32_t> sorted(std::span<const TileTriangle> all) {
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const auto order = all[a] <=> all[b];
      return order != 0 ? order < 0 : a < b;
    };
    std::vector<std::uint32_t> order(all.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto second = std::is_sorted_until(order.begin(), order.end(), before);
    if (std::is_sorted(second, order.end(), before))
      std::inplace_merge(order.begin(), second, order.end(), before);
    else
      std::sort(order.begin(), order.end(), before);
    return order;
  }

  std::vector<std::uint32_t> number_;  ///< in triangles_, of each triangle
  std::vector<std::uint32_t> firsts_;
  std::vector<TileTriangle> triangles_;
};

}  // namespace meshhier::texture
