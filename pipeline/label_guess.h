// A guess whether the numbers of an attribute name something, from the numbers alone: for
// attributes whose type and name do not say it.
#pragma once

#include "hierarchy/scalar_value.h"

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace meshhier::pipeline {

/// Looks at the values of one attribute, vertex after vertex in the order of the file. Parts are
/// looked at apart and added in their order.
class LabelGuess {
 public:
  /// Up to so many different values are few.
  static constexpr std::size_t kMostClasses = 64;
  static constexpr double kMostClass = 4095;
  /// Up to so many different values a viewer can list: then labels stay labels.
  static constexpr std::size_t kManyValues = 256;
  /// With fewer vertices no guess is made.
  static constexpr std::uint64_t kLeastSteps = 4000;

  explicit LabelGuess(const ScalarAttribute& attribute) : attribute_(attribute) {}

  /// Adds vertices whose channels lie `stride` floats apart, the first ones at `channels`.
  void add(const float* channels, std::size_t stride, std::size_t vertices);
  /// Adds the vertices behind.
  void add(const LabelGuess& next);

  /// Whether integers that are taken for labels are none: there are more than kManyValues, and nine
  /// vertices of ten have another one than the vertex before. Objects and classes lie together.
  bool is_quantity() const;
  /// Returns the values of a quantity in floats that may be a label: they are two or more but few,
  /// and whole numbers from 0 to kMostClass. Else returns none.
  std::vector<double> classes() const;

 private:
  void add_value(double value);

  ScalarAttribute attribute_;
  std::set<double> values_;  ///< up to kManyValues and one more
  bool all_are_classes_ = true;
  std::uint64_t steps_ = 0;    ///< from a vertex to the next one
  std::uint64_t changes_ = 0;  ///< those to another value
};

/// Returns the line of the config that makes labels of attributes: `"labels": ["class", "object"]`.
std::string labels_line(const std::vector<std::string>& names);

}  // namespace meshhier::pipeline
