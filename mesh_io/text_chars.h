// Characters that separate words and lines, and words in lists.
#pragma once

#include <algorithm>
#include <span>
#include <string_view>

namespace meshhier::mesh_io {

constexpr bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

inline bool is_one_of(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

}  // namespace meshhier::mesh_io
