#include "server/health_question.h"

#include "base/plain_text.h"
#include "server/http_server.h"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include <httplib.h>

namespace meshhier::server {
namespace {

constexpr std::chrono::seconds kPatience{5};
/// A reply of ours has some hundred bytes.
constexpr std::size_t kMostReplyBytes = 4096;

}  // namespace

HealthAnswer ask_health(const std::string& host, std::uint16_t port, Health health) {
  const std::string url = url_of(host, port);
  httplib::Client client(url.substr(0, url.size() - 1));
  client.set_connection_timeout(kPatience);
  client.set_read_timeout(kPatience);
  std::string text;
  const auto result = client.Get(
      health == Health::alive ? "/healthz" : "/readyz", [&](const char* bytes, std::size_t count) {
        text.append(bytes, std::min(count, kMostReplyBytes - text.size()));
        return text.size() < kMostReplyBytes;
      });
  if (!result)
    return {false, url + ": no answer: does a server run there, with this --host and --port?"};
  text.erase(text.find_last_not_of("\r\n") + 1);
  return {result->status == 200, result->status == 404 ? url + ": another server answers there"
                                                       : plain_text(text, kMostReplyBytes)};
}

}  // namespace meshhier::server
