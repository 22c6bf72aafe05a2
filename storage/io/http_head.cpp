#include "storage/io/http_head.h"

#include "base/number_text.h"
#include "base/small_letters.h"
#include "base/trimmed.h"

namespace meshhier::storage {

void HttpHead::add(std::string_view line) {
  if (line.starts_with("HTTP/"))
    *this = {};
  bytes += line.size();
  constexpr std::string_view kBlanks = " \t\r\n";
  is_complete = trimmed(line, kBlanks).empty();
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || line.starts_with("HTTP/"))
    return;
  const std::string name = small_letters(line.substr(0, colon));
  const std::string_view value = trimmed(line.substr(colon + 1), kBlanks);
  if (name == "etag")
    etag_ = value.starts_with("W/") ? value.substr(2) : value;
  else if (name == "last-modified")
    modified_ = value;
  else if (name == "content-encoding")
    encoding = small_letters(value) == "identity" ? "" : value;
  else if (name == "content-length")
    length = length_of(value);
  else if (name == "content-range")
    add_range(value);
}

/// Parses a length in bytes; nothing if no file can be so long, which is noted.
std::optional<std::uint64_t> HttpHead::length_of(std::string_view text) {
  const std::optional<std::uint64_t> value = parse_number<std::uint64_t>(text);
  if (value && *value <= static_cast<std::uint64_t>(INT64_MAX))
    return value;
  if (!text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos)
    impossible = text.substr(0, 40);
  return std::nullopt;
}

/// Takes "bytes 0-99/1234", or "bytes */1234" where the file ends before the part.
void HttpHead::add_range(std::string_view value) {
  constexpr std::string_view kUnit = "bytes ";
  const std::size_t slash = value.find('/');
  if (!value.starts_with(kUnit) || slash == std::string_view::npos)
    return;
  total = length_of(value.substr(slash + 1));
  const std::size_t dash = value.find('-');
  if (dash != std::string_view::npos && dash < slash)
    first = parse_number<std::uint64_t>(value.substr(kUnit.size(), dash - kUnit.size()));
}

}  // namespace meshhier::storage
