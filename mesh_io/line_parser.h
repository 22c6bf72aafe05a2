// Reads lines of a text in memory that may or may not have the expected form.
#pragma once

#include "mesh_io/text_chars.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace meshhier::mesh_io {

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
constexpr bool is_of_number(char c) {
  return is_digit(c) || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

/// Reads a line from its start on. Its results count only if the whole line has the expected form;
/// else the caller reads the line by words, which tell errors.
class LineParser {
 public:
  LineParser(const char* at, const char* end) : at_(at), end_(end) {}

  const char* at() const { return at_; }
  bool has_more() const { return at_ != end_; }
  bool is_at_end() const { return at_ == end_ || is_line_end(*at_); }
  char next() const { return at_ == end_ ? '\n' : *at_; }

  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_))
      ++at_;
  }
  bool take(char c) {
    const bool is_there = at_ != end_ && *at_ == c;
    at_ += is_there ? 1 : 0;
    return is_there;
  }
  /// Takes the word here, perhaps empty.
  std::string_view take_word() {
    const char* const first = at_;
    while (!is_at_end() && !is_blank(*at_))
      ++at_;
    return {first, at_};
  }
  /// Takes the word here; empty if it has characters of no number.
  std::string_view take_number() {
    const char* const first = at_;
    while (at_ != end_ && is_of_number(*at_))
      ++at_;
    const bool is_whole = is_at_end() || is_blank(*at_);
    return is_whole ? std::string_view(first, at_) : std::string_view();
  }
  /// Takes a whole number other than 0 that fits 32 bits; nothing if there is none.
  std::optional<std::int32_t> take_index() {
    const bool is_negative = take('-');
    const char* const first = at_;
    std::int64_t value = 0;
    constexpr std::ptrdiff_t kMostDigits = 10;
    for (; at_ != end_ && is_digit(*at_) && at_ - first < kMostDigits; ++at_)
      value = value * 10 + (*at_ - '0');
    if (value == 0 || value > std::numeric_limits<std::int32_t>::max())
      return std::nullopt;
    return static_cast<std::int32_t>(is_negative ? -value : value);
  }
  void skip_line() {
    while (!is_at_end())
      ++at_;
  }
  /// Requires is_at_end().
  void take_line_end() {
    const bool is_two = at_ != end_ && *at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n';
    at_ += at_ == end_ ? 0 : is_two ? 2 : 1;
  }

 private:
  const char* at_;
  const char* end_;
};

}  // namespace meshhier::mesh_io
