// Numbers in a text.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
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

/// Parses a whole text; returns nothing if it is no finite number.
inline std::optional<double> parse_finite(std::string_view text) {
  const auto number = parse_number<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

/// Parses what has commas between it, each by `parse`; returns nothing if that finds nothing in one
/// of them. parse(std::string_view) returns a std::optional.
template <class Parse>
auto parse_list(std::string_view text, const Parse& parse) {
  std::optional<std::vector<std::decay_t<decltype(*parse(text))>>> all(std::in_place);
  while (true) {
    const std::size_t end = std::min(text.find(','), text.size());
    auto one = parse(text.substr(0, end));
    if (!one)
      all.reset();
    else
      all->push_back(*std::move(one));
    if (!all || end == text.size())
      return all;
    text.remove_prefix(end + 1);
  }
}

/// Parses finite numbers with commas between them, "1,-0.5,2e3"; nothing if one of them is none.
inline std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  return parse_list(text, parse_finite);
}

}  // namespace meshhier
