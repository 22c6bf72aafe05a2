#include "server/conditions.h"

#include "server/text.h"
#include "storage/hash.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

/// Takes what stands before the next `mark` off the front.
std::string_view take_until(std::string_view& text, char mark) {
  const std::size_t end = std::min(text.find(mark), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return trimmed(part);
}

/// "q=0", "q=0.000"
bool is_zero_weight(const std::string& parameter) {
  return parameter.starts_with("q=0") && parameter.find_first_not_of("0.", 2) == std::string::npos;
}

}  // namespace

std::string file_tag(const storage::FileVersion& version, std::uint64_t offset) {
  return fmt::format("\"{:x}-{:x}-{:x}-{:x}\"", version.inode, version.bytes,
                     static_cast<std::uint64_t>(version.modified_ns), offset);
}

std::string text_tag(std::string_view text) {
  return fmt::format("\"{:016x}\"", storage::checksum(std::as_bytes(std::span(text))));
}

bool names_tag(std::string_view if_none_match, std::string_view tag) {
  while (!if_none_match.empty()) {
    std::string_view item = take_until(if_none_match, ',');
    if (item == "*")
      return true;
    if (item.starts_with("W/"))
      item.remove_prefix(2);
    if (item == tag)
      return true;
  }
  return false;
}

bool allows_gzip(std::string_view accept_encoding) {
  bool others = false;
  while (!accept_encoding.empty()) {
    std::string_view item = take_until(accept_encoding, ',');
    const std::string coding = lower_case(take_until(item, ';'));
    const bool is_allowed = !is_zero_weight(lower_case(trimmed(item)));
    if (coding == "gzip" || coding == "x-gzip")
      return is_allowed;
    if (coding == "*")
      others = is_allowed;
  }
  return others;
}

bool is_loopback_name(std::string_view host) {
  for (const std::string_view name : {"localhost", "127.0.0.1", "[::1]"}) {
    if (lower_case(host.substr(0, name.size())) != name)
      continue;
    const std::string_view port = host.substr(name.size());
    return port.empty() || (port.front() == ':' && port.size() <= 6 &&
                            port.find_first_not_of("0123456789", 1) == std::string_view::npos);
  }
  return false;
}

}  // namespace meshhier::server
