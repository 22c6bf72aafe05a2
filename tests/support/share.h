// The share of exhaustive tests that a run does.
//
// A test that damages each byte, lets each call fail or cuts at each place is long. With
// MESHHIER_TEST_SHARE="k/n" in the environment it takes every n-th of its cases, from the k-th on
// (0 <= k < n): n runs with all k do all cases. Without, it takes all. `scripts/test` chooses k by
// the number of commits; `scripts/test all` chooses nothing.
#pragma once

#include <cstddef>

namespace meshhier::tests {

struct Share {
  std::size_t index = 0;
  std::size_t count = 1;

  /// Returns whether a test does its i-th case.
  bool has(std::size_t i) const { return i % count == index; }
  /// The share of a test that has so few cases that some shares would have none: one case then.
  Share of(std::size_t cases) const { return cases < count ? Share{index % cases, cases} : *this; }
  /// Returns how many of `cases` cases it does.
  std::size_t part_of(std::size_t cases) const {
    return cases / count + (index < cases % count ? 1 : 0);
  }
};

/// This process's share: the whole if nothing else was set.
const Share& share();

}  // namespace meshhier::tests
