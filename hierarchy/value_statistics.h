// Statistics of one attribute's values: range, histogram, which labels there are.
//
// Bins have a width that is a power of two and begin at multiples of it, so that counts of narrow
// bins add up to those of wider ones: one pass over the values is enough, in any order, and in
// parts.
#pragma once

#include "hierarchy/scalar_value.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace meshhier {

struct ValueStatistics {
  static constexpr std::size_t kMostBins = 64;
  static constexpr std::size_t kMostLabels = 256;

  struct LabelCount {
    double label = 0;
    std::uint64_t vertices = 0;
    std::string name{};  ///< what the input calls it; empty if it says nothing
    friend bool operator==(const LabelCount&, const LabelCount&) = default;
  };

  std::uint64_t missing = 0;  ///< vertices whose value is not finite
  double min = 0, max = 0;    ///< of the others; both 0 if there are none
  /// The others are counted in bins [first_bin + i, first_bin + i + 1) * 2^bin_exponent: at most
  /// kMostBins, of which the first and the last are not empty.
  int bin_exponent = 0;
  std::int64_t first_bin = 0;
  std::vector<std::uint64_t> bins{};
  /// All labels that there are, ascending; empty if they are more than kMostLabels, or no labels.
  std::vector<LabelCount> labels{};

  friend bool operator==(const ValueStatistics&, const ValueStatistics&) = default;
};

/// Makes the statistics of one attribute.
class ValueTally {
 public:
  explicit ValueTally(const ScalarAttribute& attribute);

  /// Counts vertices whose channels lie `stride` floats apart, the first ones at `channels`.
  void add(const float* channels, std::size_t stride, std::size_t vertices);
  /// Adds the counts of another tally of the same attribute.
  void add(const ValueTally& other);
  ValueStatistics statistics() const;

 private:
  void add_all(std::span<const double> values);
  void widen(double min, double max);

  ScalarAttribute attribute_;
  std::uint64_t missing_ = 0;
  std::optional<std::pair<double, double>> range_;
  int exponent_ = 0;
  std::int64_t first_bin_ = 0;
  std::vector<std::uint64_t> bins_;  ///< of the range
  std::map<double, std::uint64_t> labels_;
  bool has_too_many_labels_ = false;
};

}  // namespace meshhier
