// Texts without what is around them.
#pragma once

#include <cstddef>
#include <string_view>

namespace meshhier {

/// Returns a text without the `blanks` at its front and back.
constexpr std::string_view trimmed(std::string_view text, std::string_view blanks = " \t") {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos)
    return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

}  // namespace meshhier
