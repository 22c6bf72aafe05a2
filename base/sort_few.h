// A sort for many groups of a handful.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace meshhier {

/// Sorts by ascending key: two or three values as a rule, for which std::sort takes three times as
/// long, by insertion; more than 16 are left to it. O(n log n).
template <class T, class Key>
void sort_few(std::span<T> values, const Key& key) {
  constexpr std::size_t kFew = 16;
  if (values.size() > kFew) {
    std::sort(values.begin(), values.end(),
              [&](const T& a, const T& b) { return key(a) < key(b); });
    return;
  }
  for (std::size_t i = 1; i < values.size(); ++i) {
    const T moved = values[i];
    std::size_t place = i;
    for (; place > 0 && key(moved) < key(values[place - 1]); --place)
      values[place] = values[place - 1];
    values[place] = moved;
  }
}

}  // namespace meshhier
