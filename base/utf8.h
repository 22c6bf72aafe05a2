// Texts in UTF-8, and those that should be.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace meshhier {

/// Whether `text` is UTF-8 (RFC 3629): no overlong form, no half of a pair, nothing above U+10FFFF.
constexpr bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned first = byte(i);
    const std::size_t bytes = first < 0x80   ? 1
                              : first < 0xC2 ? 0
                              : first < 0xE0 ? 2
                              : first < 0xF0 ? 3
                              : first < 0xF5 ? 4
                                             : 0;
    if (bytes == 0 || bytes > text.size() - i)
      return false;
    for (std::size_t k = 1; k < bytes; ++k) {
      if ((byte(i + k) & 0xC0U) != 0x80U)
        return false;
    }
    const unsigned second = bytes > 2 ? byte(i + 1) : 0;
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) ||
        (first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90))
      return false;
    i += bytes;
  }
  return true;
}

/// Returns `text` in UTF-8: each byte that is part of no character becomes U+FFFD.
std::string sound_utf8(std::string_view text);
/// Returns `text` in UTF-8: each byte that is part of no character becomes that of Windows-1252, as
/// tables and names of Western Europe have them, or U+FFFD where that has none.
std::string utf8_of_windows(std::string_view text);

}  // namespace meshhier
