#include "server/request_head.h"

#include "base/small_letters.h"
#include "base/trimmed.h"
#include "server/conditions.h"
#include "server/line_ends.h"
#include "storage/io/http_token.h"
#include "storage/io/web_address.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

/// HTTP's own (RFC 9110, section 9; RFC 5789): what it does not have gets 501, also its like in
/// small letters.
constexpr std::array<std::string_view, 9> kHttpMethods{
    "CONNECT", "DELETE", "GET", "HEAD", "OPTIONS", "PATCH", "POST", "PUT", "TRACE"};

RefusedHead unclear() {
  return {400, "Bad Request",
          "This is no request of HTTP/1.1 that all would read in the same way."};
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool has_controls(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7f';
  });
}

struct Target {
  std::string path;                 ///< with its query
  std::optional<std::string> host;  ///< of a whole address: it counts instead of the header's
};
/// Parses a target, which may be a whole address (RFC 9112, section 3.2.2), "*" or, for CONNECT,
/// what it likes: it is refused; returns nothing for what is none, an address without a host, or
/// with somebody's name before it.
std::optional<Target> parse_target(std::string_view method, std::string_view target) {
  const bool is_path =
      target.starts_with('/') || method == "CONNECT" || (method == "OPTIONS" && target == "*");
  if (is_path)
    return Target{std::string(target), std::nullopt};
  if (!storage::is_web_address(target))
    return std::nullopt;
  const std::string_view address = target.substr(target.find("//") + 2);
  const std::size_t end = std::min(address.find_first_of("/?#"), address.size());
  const std::string_view host = address.substr(0, end), path = address.substr(end);
  if (host.empty() || !is_host(host))
    return std::nullopt;
  return Target{(path.starts_with('/') ? "" : "/") + std::string(path), std::string(host)};
}

struct RequestLine {
  std::string_view method, version;
  Target target;
};
/// Parses method, target and version, with one blank between them and none elsewhere.
std::optional<RequestLine> parse_request_line(std::string_view line) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == last || !storage::is_http_token(line.substr(0, first)) || has_controls(line) ||
      line.find('\t') != std::string_view::npos)
    return std::nullopt;
  const std::string_view word = line.substr(first + 1, last - first - 1);
  if (word.empty() || word.find(' ') != std::string_view::npos || last + 1 == line.size())
    return std::nullopt;
  auto target = parse_target(line.substr(0, first), word);
  if (!target)
    return std::nullopt;
  return RequestLine{line.substr(0, first), line.substr(last + 1), std::move(*target)};
}

/// Returns the refusal of a first line that asks in a way which HTTP does not have, or newer
/// versions alone.
std::optional<RefusedHead> refuse_way(const RequestLine& line) {
  if (line.version.size() != 8 || !line.version.starts_with("HTTP/") || line.version[6] != '.' ||
      !is_digit(line.version[5]) || !is_digit(line.version[7]))
    return unclear();
  if (line.version[5] != '1')
    return RefusedHead{505, "HTTP Version Not Supported", "This server speaks HTTP/1.1."};
  if (std::ranges::find(kHttpMethods, line.method) == kHttpMethods.end())
    return RefusedHead{501, "Not Implemented", "This server does not know that method."};
  return std::nullopt;
}

/// Whether it is a length of at most 19 digits, so that it fits 64 bits.
bool is_length(std::string_view text) {
  return !text.empty() && text.size() < 20 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

std::string_view take_line(std::string_view& rest) {
  const std::string_view line = rest.substr(0, rest.find(kLineEnd));
  rest.remove_prefix(line.size() + kLineEnd.size());
  return line;
}

bool has_only_whole_lines(std::string_view raw) {
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const bool ends = raw[i] == '\r' && i + 1 < raw.size() && raw[i + 1] == '\n';
    if (ends)
      ++i;
    else if (raw[i] == '\r' || raw[i] == '\n' || raw[i] == '\0')
      return false;
  }
  return raw.ends_with("\r\n\r\n");
}

bool has_long_line(std::string_view raw) {
  while (raw != kLineEnd) {
    if (take_line(raw).size() > kMostLineBytes)
      return true;
  }
  return false;
}

struct Header {
  std::string name;  ///< in lower case
  std::string_view value;
};
/// Parses a header from a line without its end; returns nothing if it is none.
std::optional<Header> parse_header(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !storage::is_http_token(line.substr(0, colon)) ||
      has_controls(line))
    return std::nullopt;
  return Header{small_letters(line.substr(0, colon)), trimmed(line.substr(colon + 1))};
}

/// The headers that may be there once, and decide how the rest is read.
class Framing {
 public:
  /// Takes a header; returns false if it contradicts those before, or means nothing.
  bool take(const Header& header) {
    if (header.name == "host")
      return ++hosts_ == 1 && is_host(header.value);
    if (header.name == "content-length")
      has_body_ = has_body_ || header.value.find_first_not_of('0') != std::string_view::npos;
    else if (header.name == "transfer-encoding")
      has_body_ = true;
    else
      return true;
    const bool is_clear = header.name == "content-length"
                              ? take_length(header.value)
                              : small_letters(header.value) == "chunked";
    return is_clear && ++lengths_ == 1;
  }
  bool has_host() const { return hosts_ > 0; }
  bool has_body() const { return has_body_; }
  std::optional<std::uint64_t> body_bytes() const { return body_bytes_; }

 private:
  bool take_length(std::string_view text) {
    if (!is_length(text))
      return false;
    body_bytes_ = std::stoull(std::string(text));
    return true;
  }

  int hosts_ = 0, lengths_ = 0;
  bool has_body_ = false;
  std::optional<std::uint64_t> body_bytes_;
};

RequestHead begin_head(const RequestLine& line, std::string_view version) {
  const auto& [path, host] = line.target;
  RequestHead head{.text = fmt::format("{} {} {}{}", line.method, path, version, kLineEnd)};
  if (host)
    head.text += fmt::format("Host: {}{}", *host, kLineEnd);
  return head;
}

/// Takes the lines behind the first one, with the empty one, into a head that may have its host
/// already; returns false if they are not clear.
bool take_headers(std::string_view lines, bool has_host, Framing& framing, RequestHead& head) {
  std::size_t ranges = 0;
  while (lines != kLineEnd) {
    const std::string_view line = take_line(lines);
    const std::optional<Header> header = parse_header(line);
    if (!header || !framing.take(*header))
      return false;
    const auto& [name, value] = *header;
    head.is_last = head.is_last || (name == "connection" && has_item(value, "close"));
    if (name == "range")
      head.range = ++ranges == 1 ? std::optional<std::string>(value) : std::nullopt;
    else if (name == "expect" && small_letters(value) == "100-continue")
      head.expects_continue = true;
    else if (!(has_host && name == "host"))
      head.text.append(line).append(kLineEnd);
  }
  head.text += kLineEnd;
  return true;
}

}  // namespace

RefusedHead refuse_size(std::string_view begin) {
  if (begin.find(kLineEnd) > kMostLineBytes)
    return {414, "URI Too Long",
            fmt::format("The first line has more than {} bytes.", kMostLineBytes)};
  return {431, "Request Header Fields Too Large",
          fmt::format("The head of the request has more than {} bytes, or a line of it more "
                      "than {}.",
                      kMostHeadBytes, kMostLineBytes)};
}

std::variant<RequestHead, RefusedHead> parse_head(std::string_view raw) {
  if (!has_only_whole_lines(raw))
    return unclear();
  if (has_long_line(raw))
    return refuse_size(raw);
  const auto first = parse_request_line(take_line(raw));
  if (!first)
    return unclear();
  if (auto refused = refuse_way(*first))
    return std::move(*refused);
  const bool needs_host = first->version != "HTTP/1.0";
  RequestHead head = begin_head(*first, needs_host ? "HTTP/1.1" : first->version);
  Framing framing;
  if (!take_headers(raw, first->target.host.has_value(), framing, head))
    return unclear();
  if (needs_host && !framing.has_host())
    return RefusedHead{400, "Bad Request", "The request names no host (Host: NAME)."};
  head.has_body = framing.has_body();
  head.body_bytes = framing.body_bytes();
  return head;
}

}  // namespace meshhier::server
