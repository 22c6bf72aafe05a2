// Sums up distances, signed or not, each with a weight, and tells their distribution.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier::comparing {

/// Weighted sums and a histogram of distances, in 2048 bins for each doubling. For one thread.
class DistanceTally {
 public:
  /// `tolerance`: weights of distances that are no larger are summed apart.
  explicit DistanceTally(std::optional<double> tolerance);

  /// Adds a finite distance with a weight >= 0. The order of calls decides how sums are rounded.
  void add(double distance, double weight);

  double weight() const { return weight_; }
  double weight_within() const { return within_; }
  bool empty() const { return !(weight_ > 0); }
  double least() const { return least_; }
  double largest() const { return largest_; }
  /// Returns the largest distance without its sign.
  double farthest() const;
  double mean() const;       ///< 0 if empty, as the next two
  double mean_size() const;  ///< the mean of distances without their sign
  double rms() const;

  /// Returns the distance that `part` of the weight is at most, to a part in 2048 of itself.
  /// Requires that it is not empty; part in [0, 1]. O(bins).
  double quantile(double part) const;
  /// Does the same for distances without their sign.
  double size_quantile(double part) const;
  /// Returns the weight in `bins` intervals of equal width between `from` and `to`; distances
  /// beyond count in the first and the last.
  std::vector<double> histogram(double from, double to, std::size_t bins) const;

 private:
  std::optional<double> tolerance_;
  std::vector<double> bins_;  ///< by the first bits of the distance as a float
  double weight_ = 0, within_ = 0, sum_ = 0, sum_of_sizes_ = 0, sum_of_squares_ = 0;
  double least_ = 0, largest_ = 0;
  bool has_any_ = false;
};

}  // namespace meshhier::comparing
