#include "server/url_path.h"

#include "base/percent_code.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace meshhier::server {
namespace {

// The limits of Linux: NAME_MAX and PATH_MAX.
constexpr std::size_t kLongestPart = 255;
constexpr std::size_t kLongestPath = 4095;

constexpr std::string_view kHexDigits = "0123456789ABCDEF";

bool is_plain(char c) {
  return static_cast<unsigned char>(c) >= ' ' && c != '\x7f' && c != '/' && c != '\\';
}

/// Decodes one part between slashes.
std::optional<std::string> decode_part(std::string_view part) {
  std::optional<std::string> name = percent_decoded(part);
  return name && is_plain_name(*name) ? std::move(name) : std::nullopt;
}

bool is_unreserved(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-._~/").find(c) != std::string_view::npos;
}

}  // namespace

bool is_plain_name(std::string_view name) {
  return !name.empty() && name.front() != '.' && name.size() <= kLongestPart &&
         std::all_of(name.begin(), name.end(), is_plain);
}

std::optional<std::string_view> query_value(std::string_view target, std::string_view key) {
  std::size_t at = target.find('?');
  while (at != std::string_view::npos) {
    const std::size_t begin = at + 1;
    at = target.find('&', begin);
    const std::string_view pair = target.substr(begin, at == target.npos ? at : at - begin);
    if (pair.starts_with(key) && pair.substr(key.size()).starts_with('='))
      return pair.substr(key.size() + 1);
  }
  return std::nullopt;
}

std::optional<std::string> decode_path(std::string_view target) {
  target = target.substr(0, target.find('?'));
  if (!target.starts_with('/'))
    return std::nullopt;
  std::string path;
  if (target == "/")
    return path;
  while (!target.empty()) {
    target.remove_prefix(1);
    const std::size_t end = std::min(target.find('/'), target.size());
    const std::optional<std::string> part = decode_part(target.substr(0, end));
    if (!part)
      return std::nullopt;
    path += path.empty() ? *part : '/' + *part;
    if (path.size() > kLongestPath)
      return std::nullopt;
    target.remove_prefix(end);
  }
  return path;
}

std::string encode_path(std::string_view path) {
  std::string text;
  for (const char c : path) {
    if (is_unreserved(c)) {
      text += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      text += '%';
      text += kHexDigits[byte / 16];
      text += kHexDigits[byte % 16];
    }
  }
  return text;
}

}  // namespace meshhier::server
