// Numbers that are arguments.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace meshhier::app {

/// Parses a whole text; returns nothing if it is no number.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = error == std::errc{} && end == text.data() + text.size();
  return is_whole ? std::optional(number) : std::nullopt;
}

}  // namespace meshhier::app
