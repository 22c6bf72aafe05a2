#include "server/job.h"

#include "base/named_value.h"
#include "base/plain_text.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace meshhier::server {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kStates{NamedValue{"waiting", JobState::waiting},
                             NamedValue{"building", JobState::building},
                             NamedValue{"failed", JobState::failed}};
constexpr std::size_t kLongestMessage = 1000;
constexpr std::size_t kMostWarnings = 100;

std::optional<double> number(const Json& event, const char* key) {
  const auto found = event.find(key);
  if (found == event.end() || !found->is_number())
    return std::nullopt;
  return found->get<double>();
}

std::string text(const Json& event, const char* key) {
  const auto found = event.find(key);
  return found != event.end() && found->is_string() ? found->get<std::string>() : std::string();
}

void take_stage(Job& job, const Json& event) {
  job.stage = text(event, "stage");
  const auto done = number(event, "done");
  const auto total = number(event, "total");
  job.progress.reset();
  if (done && total && *total > 0)
    job.progress = std::clamp(*done / *total, 0.0, 1.0);
  job.seconds_left = number(event, "eta_seconds");
}

void take_warning(Job& job, const std::string& message) {
  const std::string line = plain_text(message, kLongestMessage);
  if (job.warnings.size() < kMostWarnings &&
      std::ranges::find(job.warnings, line) == job.warnings.end())
    job.warnings.push_back(line);
}

}  // namespace

Json to_json(const Job& job) {
  Json object{{"name", job.name}, {"state", name_in(kStates, job.state)}};
  if (!job.stage.empty())
    object["stage"] = job.stage;
  if (job.progress)
    object["progress"] = *job.progress;
  if (job.seconds_left)
    object["seconds_left"] = *job.seconds_left;
  if (!job.message.empty())
    object["message"] = job.message;
  return object;
}

void take_line(Job& job, std::string_view line) {
  const Json event = storage::parse_ordered_json_text(line, nullptr, {.throws = false});
  if (!event.is_object()) {
    if (!line.empty())
      job.message = plain_text(line, kLongestMessage);
  } else if (event.contains("stage")) {
    take_stage(job, event);
  } else if (text(event, "event") == "warning") {
    take_warning(job, text(event, "message"));
  } else if (event.contains("message")) {
    job.message = plain_text(text(event, "message"), kLongestMessage);
  }
}

}  // namespace meshhier::server
