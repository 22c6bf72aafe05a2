#include "server/view_requests.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "server/folder_scan.h"
#include "server/url_path.h"
#include "storage/format/view_edit.h"
#include "storage/format/view_keys.h"
#include "storage/io/json_text.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kModelsBegin = "/models/", kViewEnd = "/view";
constexpr std::size_t kShownKeyBytes = 60;

std::string_view without_query(std::string_view target) {
  return target.substr(0, target.find('?'));
}

std::variant<std::string, Reply> view_text_of(const Request& request) {
  if (request.body == nullptr)
    return text_reply(411, "The request must say how long its body is (Content-Length).");
  if (request.body->bytes() > storage::kMostViewBytes)
    return text_reply(413, fmt::format("A view has at most {} bytes.", storage::kMostViewBytes));
  std::string text(request.body->bytes(), '\0');
  std::size_t read = 0;
  while (read < text.size()) {
    const std::size_t count =
        request.body->read(std::as_writable_bytes(std::span(text)).subspan(read));
    if (count == 0)
      return text_reply(400, "The request has ended before its body.");
    read += count;
  }
  return text;
}

std::variant<ModelView, Reply> view_in(const std::string& text) {
  const Json json = storage::parse_ordered_json_text(text, nullptr, {.throws = false});
  if (json.is_discarded())
    return text_reply(400, "The body is no JSON.");
  auto read = storage::parse_view(json);
  if (const auto* problem = std::get_if<storage::ViewProblem>(&read)) {
    const std::string key = problem->key.empty() ? "" : '.' + problem->key;
    return text_reply(400, fmt::format("view{}: expected {}.", plain_text(key, kShownKeyBytes),
                                       problem->expected));
  }
  return std::get<ModelView>(std::move(read));
}

Reply refused(const Error& error) {
  switch (error.code()) {
    case ErrorCode::exists:
    case ErrorCode::locked:
      return text_reply(409,
                        "Another build of this hierarchy is there by now, or somebody else "
                        "changes it: load it again.");
    case ErrorCode::usage:
      return text_reply(400, "The hierarchy does not have the attribute that the view names.");
    default:
      return text_reply(507, "The view could not be stored; the server's terminal says why.");
  }
}

}  // namespace

ViewRequests::ViewRequests(std::filesystem::path folder, const Uploads& uploads,
                           Hierarchies& hierarchies, storage::FileSystem& files,
                           Hierarchies::Tell tell)
    : folder_(std::move(folder)),
      uploads_(uploads),
      hierarchies_(hierarchies),
      files_(files),
      tell_(std::move(tell)) {}

bool ViewRequests::is_view(std::string_view target) {
  const std::string_view path = without_query(target);
  return path.starts_with(kModelsBegin) && path.ends_with(kViewEnd);
}

Reply ViewRequests::take(const Request& request) {
  if (auto refused = uploads_.refuse_change(request))
    return std::move(*refused);
  std::string_view target = without_query(request.target);
  target.remove_suffix(kViewEnd.size());
  const std::optional<std::string> path = decode_path(target);
  if (!path)
    return text_reply(404, "There is no such hierarchy.");
  const std::string name = path->substr(std::min(kModelsBegin.size() - 1, path->size()));
  if (is_archive_name(name))
    return text_reply(409, "An archive is never changed: build it with the view in its config.");
  const auto model = hierarchies_.look(name);
  if (!model || model->build.empty())
    return text_reply(404, "There is no such hierarchy.");
  return replace(request, name);
}

Reply ViewRequests::replace(const Request& request, const std::string& path) {
  auto body = view_text_of(request);
  if (auto* reply = std::get_if<Reply>(&body))
    return std::move(*reply);
  auto read = view_in(std::get<std::string>(body));
  if (auto* reply = std::get_if<Reply>(&read))
    return std::move(*reply);
  const auto& view = std::get<ModelView>(read);
  const auto wanted = query_value(request.target, "build");
  try {
    const std::string build = storage::replace_view(
        files_, folder_ / path, view, wanted ? std::optional<std::string>(*wanted) : std::nullopt);
    const Json answer{{"build", build}, {"view", storage::view_json(view)}};
    return {.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}},
            .text = storage::json_text(answer, {.indent = 2}) + '\n'};
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error& error) {
    tell_(fmt::format("the view of {}: {}", path, error.what()));
    return refused(error);
  }
}

}  // namespace meshhier::server
