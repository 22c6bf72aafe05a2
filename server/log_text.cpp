#include "server/log_text.h"

#include "base/plain_text.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cstddef>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace meshhier::server {
namespace {

using Json = nlohmann::ordered_json;

/// Lines are cut there: names and messages come from files that nobody vouches for.
constexpr std::size_t kLongestLogMessage = 4096;
/// A word that a client sent is cut there.
constexpr std::size_t kLongestWord = 200;

/// The keys that a query of ours has (catalogue.h, site.h).
constexpr std::array<std::string_view, 9> kQueryKeys{"build",  "count",  "first", "order", "path",
                                                     "places", "search", "state", "tag"};
constexpr std::string_view kHidden = "...";

/// Returns a part of a query, "key=value", without the value of a foreign key.
std::string shown_part(std::string_view part) {
  const std::size_t sign = part.find('=');
  if (std::ranges::find(kQueryKeys, part.substr(0, sign)) != kQueryKeys.end())
    return std::string(part);
  return std::string(sign == std::string_view::npos ? "" : part.substr(0, sign + 1))
      .append(kHidden);
}

std::string without_secrets(std::string_view target) {
  const std::size_t query = target.find('?');
  std::string shown(target.substr(0, query));
  for (std::size_t at = query; at < target.size();) {
    const std::size_t end = std::min(target.find('&', at + 1), target.size());
    shown += target[at] + shown_part(target.substr(at + 1, end - at - 1));
    at = end;
  }
  return shown;
}

/// Returns a word that a client sent as visible ASCII.
std::string escaped(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, kLongestWord)) {
    if (c > ' ' && c < '\x7f')
      text += c;
    else
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
  return word.size() > kLongestWord ? text.append(kHidden) : text;
}

Json json_head(LogTime time, LogLevel level) {
  return {{"time", utc_text(time)}, {"level", name_in(kLogLevels, level)}};
}

std::string text_head(LogTime time, LogLevel level) {
  return fmt::format("{} {}", utc_text(time), name_in(kLogLevels, level));
}

}  // namespace

std::string utc_text(LogTime time) {
  const auto whole = std::chrono::floor<std::chrono::seconds>(time);
  const auto part = std::chrono::duration_cast<std::chrono::milliseconds>(time - whole);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(whole)), part.count());
}

std::string log_line(LogFormat format, LogTime time, LogLevel level, std::string_view message) {
  const std::string text = plain_text(message, kLongestLogMessage);
  if (format == LogFormat::text)
    return text_head(time, level) + ' ' + text;
  Json object = json_head(time, level);
  object["message"] = text;
  return storage::json_text(object);
}

std::string log_line(LogFormat format, LogTime time, const Served& served) {
  const std::string method = escaped(served.method);
  const std::string target = escaped(without_secrets(served.target));
  if (format == LogFormat::text) {
    return fmt::format("{} {} {} {} {} {}", text_head(time, LogLevel::info), served.client, method,
                       target, served.status, served.bytes);
  }
  Json object = json_head(time, LogLevel::info);
  object.update(Json{{"client", served.client},
                     {"method", method},
                     {"target", target},
                     {"status", served.status},
                     {"bytes", served.bytes}});
  return storage::json_text(object);
}

}  // namespace meshhier::server
