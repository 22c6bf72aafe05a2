#include "base/percent_code.h"

#include <cctype>
#include <cstddef>

namespace meshhier {
namespace {

/// -1 if it is no hexadecimal digit.
int hex_digit(char c) {
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  const std::size_t value =
      kHexDigits.find(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  return value == std::string_view::npos ? -1 : static_cast<int>(value);
}

}  // namespace

std::optional<std::string> percent_decoded(std::string_view part) {
  std::string bytes;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (part[i] != '%') {
      bytes += part[i];
      continue;
    }
    const int high = i + 2 < part.size() ? hex_digit(part[i + 1]) : -1;
    const int low = i + 2 < part.size() ? hex_digit(part[i + 2]) : -1;
    if (high < 0 || low < 0)
      return std::nullopt;
    bytes += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return bytes;
}

std::string percent_encoded(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF", kPlain = "-_.!~*'()";
  std::string part;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain =
        (byte < 0x80 && std::isalnum(byte) != 0) || kPlain.find(c) != std::string_view::npos;
    if (is_plain)
      part += c;
    else
      part.append({'%', kDigits[byte >> 4], kDigits[byte & 15]});
  }
  return part;
}

}  // namespace meshhier
