#include "server/request_head.h"

#include "base/small_letters.h"
#include "base/trimmed.h"
#include "server/line_ends.h"
#include "storage/io/http_token.h"
#include "storage/io/web_address.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

bool has_controls(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7f';
  });
}

struct Target {
  std::string path;                 ///< with its query
  std::optional<std::string> host;  ///< of a whole address: it counts instead of the header's
};
/// Parses a target, which may be a whole address (RFC 9112, section 3.2.2); returns nothing for an
/// address without a host, or with somebody's name before it.
std::optional<Target> parse_target(std::string_view target) {
  if (!storage::is_web_address(target))
    return Target{std::string(target), std::nullopt};
  const std::string_view address = target.substr(target.find("//") + 2);
  const std::size_t end = std::min(address.find_first_of("/?#"), address.size());
  const std::string_view host = address.substr(0, end), path = address.substr(end);
  if (host.empty() || host.find('@') != std::string_view::npos)
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
  auto target = parse_target(word);
  if (!target)
    return std::nullopt;
  return RequestLine{line.substr(0, first), line.substr(last + 1), std::move(*target)};
}

/// Whether it is a length of at most 19 digits, so that it fits 64 bits.
bool is_length(std::string_view text) {
  return !text.empty() && text.size() < 20 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
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
      return ++hosts_ == 1;
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

std::string_view take_line(std::string_view& rest) {
  const std::string_view line = rest.substr(0, rest.find(kLineEnd));
  rest.remove_prefix(line.size() + kLineEnd.size());
  return line;
}

}  // namespace

std::optional<RequestHead> parse_head(std::string_view raw) {
  if (!has_only_whole_lines(raw))
    return std::nullopt;
  const auto first = parse_request_line(take_line(raw));
  if (!first)
    return std::nullopt;
  const auto& [path, host] = first->target;
  RequestHead head{.text =
                       fmt::format("{} {} {}{}", first->method, path, first->version, kLineEnd)};
  if (host)
    head.text += fmt::format("Host: {}{}", *host, kLineEnd);
  std::size_t ranges = 0;
  Framing framing;
  while (raw != kLineEnd) {
    const std::string_view line = take_line(raw);
    const std::optional<Header> header = parse_header(line);
    if (!header || !framing.take(*header))
      return std::nullopt;
    if (header->name == "range") {
      head.range = header->value;
      ++ranges;
    } else if (header->name == "expect" && small_letters(header->value) == "100-continue") {
      head.expects_continue = true;
    } else if (!(host && header->name == "host")) {
      head.text.append(line).append(kLineEnd);
    }
  }
  head.text += kLineEnd;
  head.has_body = framing.has_body();
  head.body_bytes = framing.body_bytes();
  if (ranges > 1)
    head.range.reset();
  return head;
}

}  // namespace meshhier::server
