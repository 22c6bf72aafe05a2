#include "server/request_head.h"

#include "server/text.h"

#include <algorithm>

namespace meshhier::server {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

bool has_only_whole_lines(std::string_view raw) {
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const bool ends = raw[i] == '\r' && i + 1 < raw.size() && raw[i + 1] == '\n';
    if (ends)
      ++i;
    else if (raw[i] == '\r' || raw[i] == '\n' || raw[i] == '\0')
      return false;
  }
  return raw.ends_with(kLineEnd);
}

}  // namespace

std::optional<RequestHead> parse_head(std::string_view raw) {
  if (!has_only_whole_lines(raw))
    return std::nullopt;
  RequestHead head;
  std::size_t ranges = 0;
  while (!raw.empty()) {
    const std::size_t end = raw.find(kLineEnd) + kLineEnd.size();
    const std::string_view line = raw.substr(0, end);
    raw.remove_prefix(end);
    const std::size_t colon = std::min(line.find(':'), line.size());
    const std::string name = lower_case(line.substr(0, colon));
    if (name == "range") {
      head.range = trimmed(line.substr(colon + 1, line.size() - colon - 1 - kLineEnd.size()));
      ++ranges;
      continue;
    }
    if (name == "content-length" || name == "transfer-encoding")
      head.has_body = true;
    head.text += line;
  }
  if (ranges > 1)
    head.range.reset();
  return head;
}

}  // namespace meshhier::server
