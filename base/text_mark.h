// The mark that editors, those of Windows above all, put before a text in UTF-8.
#pragma once

#include <string_view>

namespace meshhier {

inline constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// The text behind the mark, if it begins with one.
constexpr std::string_view without_mark(std::string_view text) {
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

}  // namespace meshhier
