#include "compare/distance_tally.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace meshhier::comparing {
namespace {

// A float's sign, its exponent and the first 11 bits of its fraction.
constexpr int kDroppedBits = 12;
constexpr std::uint32_t kSign = std::uint32_t{1} << (31 - kDroppedBits);
constexpr std::size_t kBins = std::size_t{2} * kSign;

/// Ascends with the distance.
std::size_t bin_of(double distance) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(distance)) >> kDroppedBits;
  return bits < kSign ? kSign + bits : kBins - 1 - bits;
}

/// The middle of a bin.
double bin_value(std::size_t bin) {
  const bool is_negative = bin < kSign;
  const auto bits = static_cast<std::uint32_t>(is_negative ? kSign - 1 - bin : bin - kSign);
  if (bits == 0)
    return 0;
  const std::uint32_t middle = (bits << kDroppedBits) + (1U << (kDroppedBits - 1));
  const double size = std::bit_cast<float>(middle);
  return is_negative ? -size : size;
}

}  // namespace

DistanceTally::DistanceTally(std::optional<double> tolerance)
    : tolerance_(tolerance), bins_(kBins) {}

void DistanceTally::add(double distance, double weight) {
  const double size = std::abs(distance);
  least_ = has_any_ ? std::min(least_, distance) : distance;
  largest_ = has_any_ ? std::max(largest_, distance) : distance;
  has_any_ = true;
  weight_ += weight;
  within_ += tolerance_ && size <= *tolerance_ ? weight : 0;
  sum_ += weight * distance;
  sum_of_sizes_ += weight * size;
  sum_of_squares_ += weight * distance * distance;
  bins_[bin_of(distance)] += weight;
}

double DistanceTally::farthest() const {
  return std::max(std::abs(least_), std::abs(largest_));
}
double DistanceTally::mean() const {
  return empty() ? 0 : sum_ / weight_;
}
double DistanceTally::mean_size() const {
  return empty() ? 0 : sum_of_sizes_ / weight_;
}
double DistanceTally::rms() const {
  return empty() ? 0 : std::sqrt(sum_of_squares_ / weight_);
}

double DistanceTally::quantile(double part) const {
  double below = 0;
  std::size_t last = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (!(bins_[bin] > 0))
      continue;
    last = bin;
    below += bins_[bin];
    if (below >= part * weight_)
      break;
  }
  return std::clamp(bin_value(last), least_, largest_);
}

double DistanceTally::size_quantile(double part) const {
  double below = 0;
  std::size_t last = kSign;
  for (std::size_t i = 0; i < kSign; ++i) {
    const double both = bins_[kSign + i] + bins_[kSign - 1 - i];
    if (!(both > 0))
      continue;
    last = kSign + i;
    below += both;
    if (below >= part * weight_)
      break;
  }
  return std::min(bin_value(last), farthest());
}

std::vector<double> DistanceTally::histogram(double from, double to, std::size_t bins) const {
  std::vector<double> weights(bins);
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (!(bins_[bin] > 0))
      continue;
    const double at = to > from ? (bin_value(bin) - from) / (to - from) : 0;
    const double place =
        std::clamp(at * static_cast<double>(bins), 0.0, static_cast<double>(bins) - 1);
    weights[static_cast<std::size_t>(place)] += bins_[bin];
  }
  return weights;
}

}  // namespace meshhier::comparing
