// Numbers in a text.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

namespace meshhier {

/// Parses a whole text; returns nothing if it is no number.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = error == std::errc{} && end == text.data() + text.size();
  return is_whole ? std::optional(number) : std::nullopt;
}

/// Parses finite numbers with commas between them, "1,-0.5,2e3"; nothing if one of them is none.
inline std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t end = std::min(text.find(','), text.size());
    const auto number = parse_number<double>(text.substr(0, end));
    if (!number || !std::isfinite(*number))
      return std::nullopt;
    numbers.push_back(*number);
    if (end == text.size())
      return numbers;
    text.remove_prefix(end + 1);
  }
}

}  // namespace meshhier
