#include "base/utf8.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace meshhier {
namespace {

/// Returns the bytes of the character that the text begins with; 0 if it begins with none.
std::size_t character_bytes(std::string_view text) {
  constexpr std::size_t kLongest = 4;
  for (std::size_t bytes = 1; bytes <= std::min(kLongest, text.size()); ++bytes) {
    if (is_utf8(text.substr(0, bytes)))
      return bytes;
  }
  return 0;
}

/// Replaces each byte that is part of no character by `of(byte)`.
template <class Replacement>
std::string with_sound_bytes(std::string_view text, const Replacement& of) {
  std::string sound;
  if (is_utf8(text))
    return sound = text;
  while (!text.empty()) {
    const std::size_t bytes = character_bytes(text);
    sound += bytes > 0 ? text.substr(0, bytes) : of(static_cast<unsigned char>(text[0]));
    text.remove_prefix(bytes > 0 ? bytes : 1);
  }
  return sound;
}

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
/// The characters of Windows-1252 from 0x80 to 0x9F; those behind are U+00A0 to U+00FF.
constexpr std::array<std::string_view, 32> kWindows{
    "€", kReplacement, "‚", "ƒ",          "„",          "…",          "†", "‡", "ˆ", "‰", "Š", "‹",
    "Œ", kReplacement, "Ž", kReplacement, kReplacement, "‘",          "’", "“", "”", "•", "–", "—",
    "˜", "™",          "š", "›",          "œ",          kReplacement, "ž", "Ÿ"};

}  // namespace

std::string sound_utf8(std::string_view text) {
  return with_sound_bytes(text, [](unsigned char) { return kReplacement; });
}

std::string utf8_of_windows(std::string_view text) {
  std::string latin(2, '\0');
  return with_sound_bytes(text, [&](unsigned char byte) -> std::string_view {
    if (byte < 0xA0)
      return kWindows[byte - 0x80U];
    latin[0] = static_cast<char>(0xC0U | byte >> 6U);
    latin[1] = static_cast<char>(0x80U | (byte & 0x3FU));
    return latin;
  });
}

}  // namespace meshhier
