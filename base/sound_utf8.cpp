#include "base/sound_utf8.h"

#include "base/utf8.h"

#include <algorithm>
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

}  // namespace

std::string sound_utf8(std::string_view text) {
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
  std::string sound;
  if (is_utf8(text))
    return sound = text;
  while (!text.empty()) {
    const std::size_t bytes = character_bytes(text);
    sound += bytes > 0 ? text.substr(0, bytes) : kReplacement;
    text.remove_prefix(bytes > 0 ? bytes : 1);
  }
  return sound;
}

}  // namespace meshhier
