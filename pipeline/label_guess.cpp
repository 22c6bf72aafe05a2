#include "pipeline/label_guess.h"

#include <cmath>

namespace meshhier::pipeline {

void LabelGuess::add(const float* channels, std::size_t stride, std::size_t vertices) {
  double last = 0;
  for (std::size_t v = 0; v < vertices; ++v, channels += stride) {
    if (!attribute_.is_label && !all_are_classes_)
      return;
    const double value = value_in(attribute_.type, channels);
    const bool is_step = v > 0;
    steps_ += is_step ? 1 : 0;
    changes_ += is_step && value != last ? 1 : 0;
    if (!is_step || value != last)
      add_value(value);
    last = value;
  }
}

/// Adds a value; NaN and infinities are passed over.
void LabelGuess::add_value(double value) {
  if (!std::isfinite(value))
    return;
  all_are_classes_ =
      all_are_classes_ && value >= 0 && value <= kMostClass && value == std::floor(value);
  if (values_.size() <= kManyValues)
    values_.insert(value);
  all_are_classes_ = all_are_classes_ && values_.size() <= kMostClasses;
}

void LabelGuess::add(const LabelGuess& next) {
  steps_ += next.steps_;
  changes_ += next.changes_;
  all_are_classes_ = all_are_classes_ && next.all_are_classes_;
  for (const double value : next.values_)
    add_value(value);
}

// Integers of 64 bits are kept as doubles, so the type f64 may be an integer's.
bool LabelGuess::is_quantity() const {
  constexpr std::uint64_t kOf = 10, kMost = 9;
  const bool is_whole = is_integer(attribute_.type) || attribute_.type == ValueType::f64;
  return attribute_.is_label && is_whole && values_.size() > kManyValues && steps_ >= kLeastSteps &&
         changes_ / kMost >= steps_ / kOf;
}

std::vector<double> LabelGuess::classes() const {
  if (attribute_.is_label || is_integer(attribute_.type) || !all_are_classes_ ||
      values_.size() < 2 || steps_ < kLeastSteps)
    return {};
  return {values_.begin(), values_.end()};
}

std::string labels_line(const std::vector<std::string>& names) {
  std::string line = "\"labels\": [";
  for (const std::string& name : names) {
    line += line.ends_with('[') ? "\"" : ", \"";
    for (const char c : name)
      line += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
    line += '"';
  }
  return line + ']';
}

}  // namespace meshhier::pipeline
