#include "server/conditions.h"

#include "base/small_letters.h"
#include "base/trimmed.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

/// Takes all up to the next `mark` off the front, and drops the mark.
std::string_view take_until(std::string_view& text, char mark) {
  const std::size_t end = std::min(text.find(mark), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return trimmed(part);
}

/// Whether it is "q=0", "q=0.000" ...
bool is_zero_weight(const std::string& parameter) {
  return parameter.starts_with("q=0") && parameter.find_first_not_of("0.", 2) == std::string::npos;
}

/// Whether it is a port, or empty.
bool is_port(std::string_view text) {
  return text.size() <= 5 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Whether it is an address as "127.0.0.1" or "127.1". No browser takes a text that ends with a
/// digit and is no address for a name.
bool is_loopback_address(std::string_view text) {
  return text.starts_with("127.") && !text.ends_with('.') &&
         text.find_first_not_of("0123456789.") == std::string_view::npos;
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
    const std::string coding = small_letters(take_until(item, ';'));
    const bool is_allowed = !is_zero_weight(small_letters(trimmed(item)));
    if (coding == "gzip" || coding == "x-gzip")
      return is_allowed;
    if (coding == "*")
      others = is_allowed;
  }
  return others;
}

bool is_loopback_name(std::string_view host) {
  const std::size_t colon = host.ends_with(']') ? host.size() : host.rfind(':');
  const std::string name = small_letters(host.substr(0, colon));
  const std::string_view port = host.substr(std::min(name.size() + 1, host.size()));
  return is_port(port) && (name == "localhost" || name == "[::1]" || is_loopback_address(name));
}

}  // namespace meshhier::server
