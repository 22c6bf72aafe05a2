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

constexpr std::string_view kDigits = "0123456789";

bool consists_of(std::string_view text, std::string_view characters) {
  return text.find_first_not_of(characters) == std::string_view::npos;
}

/// Whether it is a port, or empty.
bool is_port(std::string_view text) {
  return text.size() <= 5 && consists_of(text, kDigits);
}

struct HostParts {
  std::string name;  ///< in small letters
  std::string_view port;
};
/// Splits "a.org:80" or "[::1]:80" at the colon before the port.
HostParts split_host(std::string_view host) {
  const std::size_t colon = host.ends_with(']') ? host.size() : host.rfind(':');
  const std::string_view name = host.substr(0, colon);
  return {small_letters(name), host.substr(std::min(name.size() + 1, host.size()))};
}

/// Whether it is an address as "127.0.0.1" or "127.1". No browser takes a text that ends with a
/// digit and is no address for a name.
bool is_loopback_address(std::string_view text) {
  return text.starts_with("127.") && !text.ends_with('.') && consists_of(text, "0123456789.");
}

}  // namespace

std::string file_tag(const storage::FileVersion& version, std::uint64_t offset) {
  return fmt::format("\"{:x}-{:x}-{:x}-{:x}\"", version.inode, version.bytes,
                     static_cast<std::uint64_t>(version.modified_ns), offset);
}

std::string text_tag(std::string_view text) {
  return fmt::format("\"{:016x}\"", storage::checksum(std::as_bytes(std::span(text))));
}

bool names_tag(std::string_view tags, std::string_view tag, WeakTags weak) {
  while (!tags.empty()) {
    std::string_view item = take_until(tags, ',');
    if (item == "*")
      return true;
    if (weak == WeakTags::count && item.starts_with("W/"))
      item.remove_prefix(2);
    if (item == tag)
      return true;
  }
  return false;
}

std::optional<int> status_by_conditions(const Request& request, std::string_view tag) {
  if (request.if_match && !names_tag(*request.if_match, tag, WeakTags::do_not))
    return 412;
  if (request.if_none_match && names_tag(*request.if_none_match, tag))
    return 304;
  return std::nullopt;
}

bool has_item(std::string_view list, std::string_view item) {
  while (!list.empty()) {
    if (small_letters(take_until(list, ',')) == small_letters(item))
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

bool is_host(std::string_view text) {
  constexpr std::string_view kOfAddresses = ":abcdefghijklmnopqrstuvwxyz0123456789-._~!$&'()*+,;=%";
  constexpr std::string_view kOfNames = kOfAddresses.substr(1);
  const auto [name, port] = split_host(text);
  if (!is_port(port))
    return false;
  if (name.size() > 2 && name.starts_with('[') && name.ends_with(']'))
    return consists_of(std::string_view(name).substr(1, name.size() - 2), kOfAddresses);
  return consists_of(name, kOfNames);
}

bool is_loopback_name(std::string_view host) {
  const auto [name, port] = split_host(host);
  return is_port(port) && (name == "localhost" || name == "[::1]" || is_loopback_address(name));
}

}  // namespace meshhier::server
