#include "server/vitals.h"

#include "base/error.h"
#include "server/client_key.h"
#include "server/exposition.h"
#include "server/secret.h"
#include "storage/io/json_text.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kAlive = "healthz", kReady = "readyz", kMetrics = "metrics";

Reply vital_reply(int status, std::string type, std::string text) {
  return {.status = status,
          .headers = {{"Content-Type", std::move(type)}, {"Cache-Control", "no-store"}},
          .text = std::move(text)};
}

Reply json_reply(int status, const Json& json) {
  return vital_reply(status, "application/json", storage::json_text(json) + '\n');
}

Json json_of(const Check& check) {
  Json object{{"name", check.name}, {"ok", check.reason.empty()}};
  if (!check.reason.empty())
    object["reason"] = check.reason;
  return object;
}

/// Returns the reasons, "disk: ...; inbox: ..."; empty if all is so.
std::string reasons_of(const std::vector<Check>& checks) {
  std::string reasons;
  for (const Check& check : checks) {
    if (!check.reason.empty())
      reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", check.name, check.reason);
  }
  return reasons;
}

/// Whether it comes from a program on this machine: from no page, and through no proxy that says
/// so.
bool is_from_here(const Request& request) {
  return is_loopback_client(request.client) && !request.is_passed_on && !request.origin;
}

}  // namespace

Vitals::Vitals(VitalsOptions options, storage::FileSystem& files, Ask ask, Tell tell)
    : options_(std::move(options)), files_(files), ask_(std::move(ask)), tell_(std::move(tell)) {}

bool Vitals::is_vital(std::string_view path) {
  return path == kAlive || path == kReady || path == kMetrics;
}

Reply Vitals::answer(const Request& request, std::string_view path) {
  if (path == kAlive)
    return json_reply(200, {{"status", "alive"}});
  return path == kReady ? readiness() : metrics(request);
}

Reply Vitals::readiness() {
  const std::vector<Check> checks = check_readiness(options_.readiness, files_);
  const std::string reasons = reasons_of(checks);
  tell_change(reasons);
  Json list = Json::array();
  for (const Check& check : checks)
    list.push_back(json_of(check));
  return json_reply(reasons.empty() ? 200 : 503,
                    {{"status", reasons.empty() ? "ready" : "not ready"}, {"checks", list}});
}

void Vitals::tell_change(const std::string& reasons) {
  const std::lock_guard lock(mutex_);
  const bool was_ready = reasons_.empty();
  reasons_ = reasons;
  if (was_ready && !reasons.empty())
    tell_(LogLevel::warning, "not ready: " + reasons);
  else if (!was_ready && reasons.empty())
    tell_(LogLevel::info, "ready again");
}

Reply Vitals::metrics(const Request& request) {
  if (options_.token.empty() && !is_from_here(request)) {
    return text_reply(403,
                      "Figures are told to programs on this machine only: start the server with "
                      "--metrics-token-file to read them from others.");
  }
  if (!options_.token.empty() && !knows_secret(request, options_.token))
    return secret_needed();
  Figures figures = ask_();
  figures.started = started_;
  const auto add_place = [&](std::string_view name, const std::filesystem::path& place) {
    try {
      figures.free_bytes.emplace_back(name, files_.free_bytes(place));
    } catch (const Error&) {  // it is told by /readyz
    }
  };
  add_place("folder", options_.readiness.folder->path());
  if (!options_.readiness.inbox.empty())
    add_place("inbox", options_.readiness.inbox);
  return vital_reply(200, Exposition::kContentType, metrics_text(requests_, figures));
}

}  // namespace meshhier::server
