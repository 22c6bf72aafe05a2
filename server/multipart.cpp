#include "server/multipart.h"

#include "base/small_letters.h"
#include "base/trimmed.h"
#include "server/line_ends.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <utility>

namespace meshhier::server {
namespace {

/// The most bytes of a part's head; a file's name has 255.
constexpr std::size_t kMostPartHeadBytes = 4096;
constexpr std::size_t kWindowBytes = 64 * 1024;
constexpr std::size_t kLongestBoundary = 70;

using Parameters = std::map<std::string, std::string>;

/// Takes the value at the front of `text`, quoted or not. A backslash means one thing to some and
/// another one to others: there may be none.
std::optional<std::string> take_value(std::string_view& text) {
  const bool is_quoted = text.starts_with('"');
  text.remove_prefix(is_quoted ? 1 : 0);
  const std::size_t end = std::min(text.find_first_of(is_quoted ? "\"" : ";"), text.size());
  if (is_quoted && end == text.size())
    return std::nullopt;
  const std::string_view value = is_quoted ? text.substr(0, end) : trimmed(text.substr(0, end));
  text.remove_prefix(end + (is_quoted ? 1 : 0));
  if (value.find('\\') != std::string_view::npos)
    return std::nullopt;
  return std::string(value);
}

/// Parses `; name=value; name="value"`; names become lower case. Returns nothing if it is anything
/// else.
std::optional<Parameters> parse_parameters(std::string_view text) {
  Parameters parameters;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::size_t equals = text.find('=');
    if (!text.starts_with(';') || equals == std::string_view::npos)
      return std::nullopt;
    const std::string name = small_letters(trimmed(text.substr(1, equals - 1)));
    text.remove_prefix(equals + 1);
    std::optional<std::string> value = take_value(text);
    if (!value || !parameters.emplace(name, std::move(*value)).second)
      return std::nullopt;
  }
  return parameters;
}

/// Returns the parameter of a header whose value begins with `type`; nothing if it does not, or has
/// none.
std::optional<std::string> find_parameter(std::string_view value, std::string_view type,
                                          const std::string& name) {
  const std::size_t end = std::min(value.find(';'), value.size());
  if (small_letters(trimmed(value.substr(0, end))) != type)
    return std::nullopt;
  auto parameters = parse_parameters(value.substr(end));
  const auto found = parameters ? parameters->find(name) : Parameters::iterator();
  if (!parameters || found == parameters->end())
    return std::nullopt;
  return std::move(found->second);
}

bool is_boundary_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("'()+_,-./:=? ").find(c) != std::string_view::npos;
}

bool is_boundary(std::string_view text) {
  return !text.empty() && text.size() <= kLongestBoundary && !text.ends_with(' ') &&
         std::all_of(text.begin(), text.end(), is_boundary_char);
}

}  // namespace

std::optional<std::string> form_boundary(std::string_view content_type) {
  auto boundary = find_parameter(content_type, "multipart/form-data", "boundary");
  return boundary && is_boundary(*boundary) ? std::move(boundary) : std::nullopt;
}

/// The window begins with a line end, so that the first boundary is as all others.
MultipartReader::MultipartReader(Body& body, const std::string& boundary)
    : body_(body), delimiter_("\r\n--" + boundary), window_(kLineEnd) {}

/// Reads more into the window; returns false if no more comes.
bool MultipartReader::fill() {
  window_.erase(0, std::exchange(begin_, 0));
  const std::size_t before = window_.size();
  window_.resize(before + kWindowBytes);
  const std::size_t count = body_.read(std::as_writable_bytes(std::span(window_).subspan(before)));
  window_.resize(before + count);
  return count > 0;
}

/// Whether so many bytes are held, once more have come if need be.
bool MultipartReader::hold(std::size_t bytes) {
  while (held().size() < bytes) {
    if (!fill())
      return false;
  }
  return true;
}

bool MultipartReader::take(std::string_view text) {
  if (!hold(text.size()) || !held().starts_with(text))
    return false;
  begin_ += text.size();
  return true;
}

MultipartReader::Next MultipartReader::finish() {
  const bool has_line_end = take(kLineEnd);
  return (has_line_end || held().empty()) && !hold(1) ? Next::end : Next::malformed;
}

/// Takes a head with its empty line, and returns the name of the file in it: there must be exactly
/// one.
std::optional<std::string> MultipartReader::take_headers() {
  std::size_t end = held().find(kHeadEnd);
  while (end == std::string_view::npos && held().size() < kMostPartHeadBytes + kHeadEnd.size() &&
         fill())
    end = held().find(kHeadEnd);
  if (end == std::string_view::npos || end > kMostPartHeadBytes)
    return std::nullopt;
  std::string_view head = held().substr(0, end + kLineEnd.size());
  begin_ += end + kHeadEnd.size();
  std::optional<std::string> name;
  while (!head.empty()) {
    const std::string_view line = head.substr(0, head.find(kLineEnd));
    head.remove_prefix(line.size() + kLineEnd.size());
    const std::size_t colon = line.find(':');
    if (small_letters(line.substr(0, colon)) != "content-disposition")
      continue;
    if (name || colon == std::string_view::npos)
      return std::nullopt;
    name = find_parameter(line.substr(colon + 1), "form-data", "filename");
    if (!name)
      return std::nullopt;
  }
  return name;
}

MultipartReader::Next MultipartReader::next() {
  if (!take(delimiter_))
    return Next::malformed;
  if (take("--"))
    return finish();
  std::optional<std::string> name = take(kLineEnd) ? take_headers() : std::nullopt;
  if (!name)
    return Next::malformed;
  name_ = std::move(*name);
  return Next::file;
}

/// Hands out only bytes that cannot be the beginning of a boundary.
std::size_t MultipartReader::read(std::span<std::byte> bytes) {
  if (!hold(delimiter_.size()))
    return 0;
  const std::size_t found = held().find(delimiter_);
  const std::size_t most =
      found == std::string_view::npos ? held().size() - delimiter_.size() + 1 : found;
  const std::size_t count = std::min(most, bytes.size());
  std::memcpy(bytes.data(), held().data(), count);
  begin_ += count;
  return count;
}

}  // namespace meshhier::server
