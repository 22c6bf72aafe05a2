#include "hierarchy/value_statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meshhier {
namespace {

constexpr int kLeastBinExponent = -1000;
/// Numbers of bins are exact as doubles.
constexpr double kMostBinNumber = 9007199254740992.0;  // 2^53

double bin_number(double value, int exponent) {
  return std::floor(std::ldexp(value, -exponent));
}

/// The narrowest bins that the range allows: a wider range never has narrower ones.
int exponent_of(double min, double max, int least) {
  // Near what fits; of 0 there is no exponent.
  const auto start = [&](double size, int below) {
    return size > 0 ? std::max(least, std::ilogb(size) - below) : least;
  };
  int exponent =
      std::max(start(std::max(std::abs(min), std::abs(max)), 53), start(max / 2 - min / 2, 6));
  const auto fits = [&](int e) {
    const double first = bin_number(min, e), last = bin_number(max, e);
    return std::max(std::abs(first), std::abs(last)) < kMostBinNumber &&
           last - first < static_cast<double>(ValueStatistics::kMostBins);
  };
  while (exponent > least && fits(exponent - 1))
    --exponent;
  while (!fits(exponent))
    ++exponent;
  return exponent;
}

}  // namespace

ValueTally::ValueTally(const ScalarAttribute& attribute) : attribute_(attribute) {}

void ValueTally::add(const float* channels, std::size_t stride, std::size_t vertices) {
  std::vector<double> values;
  values.reserve(vertices);
  for (std::size_t v = 0; v < vertices; ++v, channels += stride) {
    const double value = value_in(attribute_.type, channels);
    if (std::isfinite(value))
      values.push_back(value);
  }
  missing_ += vertices - values.size();
  add_all(values);
}

void ValueTally::add_all(std::span<const double> values) {
  if (values.empty())
    return;
  const auto [min, max] = std::ranges::minmax(values);
  widen(min, max);
  for (const double value : values) {
    const auto bin = static_cast<std::int64_t>(bin_number(value, exponent_)) - first_bin_;
    ++bins_[static_cast<std::size_t>(bin)];
  }
  if (!attribute_.is_label)
    return;
  std::uint64_t* count = nullptr;
  double last = 0;
  for (const double value : values) {
    if (has_too_many_labels_)
      return;
    if (count == nullptr || value != last)
      count = &labels_[value];
    last = value;
    ++*count;
    has_too_many_labels_ = labels_.size() > ValueStatistics::kMostLabels;
  }
}

/// Makes the bins those of a range that contains this one too.
void ValueTally::widen(double min, double max) {
  const bool is_first = !range_;
  if (!is_first) {
    min = std::min(min, range_->first);
    max = std::max(max, range_->second);
  }
  range_ = {min, max};
  const int exponent = exponent_of(min, max, is_integer(attribute_.type) ? 0 : kLeastBinExponent);
  const auto first = static_cast<std::int64_t>(bin_number(min, exponent));
  const auto last = static_cast<std::int64_t>(bin_number(max, exponent));
  std::vector<std::uint64_t> bins(static_cast<std::size_t>(last - first) + 1);
  const int shift = std::min(exponent - exponent_, 63);
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    const std::int64_t bin = (first_bin_ + static_cast<std::int64_t>(i)) >> shift;
    if (bins_[i] > 0)
      bins[static_cast<std::size_t>(bin - first)] += bins_[i];
  }
  exponent_ = exponent;
  first_bin_ = first;
  bins_ = std::move(bins);
}

void ValueTally::add(const ValueTally& other) {
  missing_ += other.missing_;
  if (!other.range_)
    return;
  widen(other.range_->first, other.range_->second);
  const int shift = std::min(exponent_ - other.exponent_, 63);
  for (std::size_t i = 0; i < other.bins_.size(); ++i) {
    const std::int64_t bin = (other.first_bin_ + static_cast<std::int64_t>(i)) >> shift;
    if (other.bins_[i] > 0)
      bins_[static_cast<std::size_t>(bin - first_bin_)] += other.bins_[i];
  }
  has_too_many_labels_ = has_too_many_labels_ || other.has_too_many_labels_;
  for (const auto& [label, count] : other.labels_) {
    labels_[label] += count;
    has_too_many_labels_ = has_too_many_labels_ || labels_.size() > ValueStatistics::kMostLabels;
    if (has_too_many_labels_)
      return;
  }
}

ValueStatistics ValueTally::statistics() const {
  ValueStatistics result;
  result.missing = missing_;
  if (!range_)
    return result;
  result.min = range_->first;
  result.max = range_->second;
  result.bin_exponent = exponent_;
  result.first_bin = first_bin_;
  result.bins = bins_;
  if (!has_too_many_labels_) {
    for (const auto& [label, count] : labels_)
      result.labels.push_back({label, count, {}});
  }
  return result;
}

}  // namespace meshhier
