// The head of an HTTP request: its lines, its target as a path, its headers.
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "server/byte_range.h"
#include "server/conditions.h"
#include "server/request_head.h"
#include "server/url_path.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace meshhier::tests::fuzz {
namespace {

bool is_plain_part(std::string_view part) {
  return !part.empty() && part.front() != '.' && std::none_of(part.begin(), part.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' || c == '\x7f' || c == '\\';
  });
}

void check_path(std::string_view target) {
  const std::optional<std::string> path = server::decode_path(target);
  if (!path || path->empty())
    return;
  for (std::string_view rest = *path;;) {
    const std::size_t end = std::min(rest.find('/'), rest.size());
    require(is_plain_part(rest.substr(0, end)), "a path has plain parts only");
    if (end == rest.size())
      break;
    rest.remove_prefix(end + 1);
  }
  require(server::decode_path('/' + server::encode_path(*path)) == path,
          "what is encoded is decoded again");
}

void check_range(std::string_view header) {
  for (const std::uint64_t bytes :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1000}, UINT64_MAX}) {
    const server::RangeAnswer answer = server::find_range(header, bytes);
    if (answer.kind != server::RangeAnswer::Kind::part)
      continue;
    require(answer.range.bytes > 0 && answer.range.offset < bytes &&
                answer.range.bytes <= bytes - answer.range.offset,
            "a part lies in the file");
  }
}

void check_headers(std::string_view value) {
  check_range(value);
  if (server::is_loopback_name(value))
    require(server::is_host(value), "a loopback's name is a host");
  if (server::is_host(value))
    require(value.find_first_of("/@ ?#") == std::string_view::npos, "a host is a name");
  if (server::allows_gzip(value))
    require(value.find_first_of("gGxX*") != std::string_view::npos, "gzip is asked for by name");
  if (server::names_tag(value, "\"a-b\""))
    require(value.find("\"a-b\"") != std::string_view::npos ||
                value.find('*') != std::string_view::npos,
            "a tag is named in full");
}

bool is_range_line(std::string_view line) {
  std::string name(line.substr(0, 6));
  for (char& c : name)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name == "range:";
}

void check_lines(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find("\r\n");
    require(end != std::string_view::npos, "lines are whole");
    const std::string_view line = text.substr(0, end);
    require(line.find_first_of(std::string_view("\r\n\0", 3)) == std::string_view::npos,
            "a line is one for everybody");
    require(!is_range_line(line), "Range is taken out");
    require(line != "Expect: 100-continue", "the library answers no expectation");
    const std::size_t colon = line.find(": ");
    check_headers(colon == std::string_view::npos ? line : line.substr(colon + 2));
    text.remove_prefix(end + 2);
  }
}

}  // namespace

void request(Bytes input) {
  const std::string_view raw = text_of(input);
  const std::string_view first = raw.substr(0, raw.find("\r\n"));
  const std::size_t blank = std::min(first.find(' '), first.size());
  const std::string_view behind = first.substr(std::min(blank + 1, first.size()));
  check_path(behind.substr(0, behind.find(' ')));
  const auto parsed = server::parse_head(raw);
  if (const auto* refused = std::get_if<server::RefusedHead>(&parsed)) {
    require(refused->status >= 400 && !refused->why.empty(), "who is refused is told why");
    return;
  }
  const auto* head = &std::get<server::RequestHead>(parsed);
  constexpr std::size_t kPathAndHost = 2;  // "http://a" becomes "/" and a line "Host: a"
  require(head->text.size() <= raw.size() + kPathAndHost, "nothing else is added");
  require(std::ranges::count(first, ' ') == 2, "a request is three words");
  check_lines(head->text);
  if (head->range)
    check_range(*head->range);
  if (head->body_bytes)
    require(head->has_body == (*head->body_bytes > 0), "a body has as many bytes as it is said to");
}

}  // namespace meshhier::tests::fuzz
