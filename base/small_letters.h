// Words without regard to their letters' case.
#pragma once

#include <string>
#include <string_view>

namespace meshhier {

/// A to Z as a to z, whatever the locale; all else as it is.
inline std::string small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return small;
}

}  // namespace meshhier
