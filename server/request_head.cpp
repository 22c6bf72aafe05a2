#include "server/request_head.h"

#include "base/small_letters.h"
#include "base/trimmed.h"
#include "server/line_ends.h"
#include "storage/io/http_token.h"

#include <algorithm>
#include <string>

namespace meshhier::server {
namespace {

bool has_controls(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7f';
  });
}

/// Whether it is method, target and version, with one blank between them and none elsewhere.
bool is_request_line(std::string_view line) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == last || !storage::is_http_token(line.substr(0, first)) || has_controls(line) ||
      line.find('\t') != std::string_view::npos)
    return false;
  const std::string_view target = line.substr(first + 1, last - first - 1);
  return !target.empty() && target.find(' ') == std::string_view::npos && last + 1 < line.size();
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
  const std::string_view request_line = take_line(raw);
  if (!is_request_line(request_line))
    return std::nullopt;
  RequestHead head{.text = std::string(request_line).append(kLineEnd)};
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
    } else {
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
