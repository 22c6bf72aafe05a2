#include "server/gallery.h"

#include "server/folder_scan.h"
#include "server/url_path.h"
#include "storage/format/layout.h"
#include "storage/io/json_text.h"

#include <utility>

namespace meshhier::server {
namespace {

/// The disk is asked once for all pages, each of which asks every few seconds.
constexpr std::chrono::seconds kFreshFor{1};

std::string directory_of(const Model& model) {
  return model.path.empty() ? "models/" : "models/" + encode_path(model.path) + '/';
}

/// Returns the URL of a model. Without a slash an archive's would be the archive itself, which is
/// read in parts.
std::string url_of(const Model& model) {
  std::string url = directory_of(model);
  if (!is_archive_name(model.path))
    url.pop_back();
  return url;
}

nlohmann::ordered_json json_of(const Model& model) {
  nlohmann::ordered_json json{{"name", model.name},         {"path", url_of(model)},
                              {"vertices", model.vertices}, {"triangles", model.triangles},
                              {"bytes", model.bytes},       {"source", model.source}};
  if (model.modified > 0)
    json["modified"] = model.modified;
  if (model.has_preview)
    json["preview"] = directory_of(model) + storage::preview_path({}).string();
  if (model.has_story)
    json["story"] = encode_path(story_beside(model));
  return json;
}

}  // namespace

std::string story_beside(const Model& model) {
  return "models/" + storage::story_path(model.path).generic_string();
}

std::string picture_beside(const Model& model) {
  return "models/" + model.path + ".webp";
}

std::string static_gallery_json(const std::vector<Model>& models) {
  auto listed = nlohmann::ordered_json::array();
  for (const Model& model : models) {
    nlohmann::ordered_json json = json_of(model);
    if (is_archive_name(model.path)) {
      json["path"] = "models/" + encode_path(model.path);
      if (model.has_preview)
        json["preview"] = encode_path(picture_beside(model));
    }
    listed.push_back(std::move(json));
  }
  const nlohmann::ordered_json document{{"models", std::move(listed)}};
  return storage::json_text(document, {.indent = 2}) + '\n';
}

std::string gallery_json(const std::vector<Model>& models,
                         const std::optional<nlohmann::ordered_json>& jobs,
                         const PlaceNames& places, const std::optional<UploadOffer>& offer) {
  nlohmann::ordered_json document{{"models", nlohmann::ordered_json::array()}};
  for (const Model& model : models) {
    nlohmann::ordered_json json = json_of(model);
    if (jobs && !model.warnings.empty())
      json["warnings"] = model.warnings;
    document["models"].push_back(std::move(json));
  }
  if (jobs)
    document["jobs"] = *jobs;
  if (!places.folder.empty())
    document["folder"] = places.folder;
  if (!places.inbox.empty())
    document["inbox"] = places.inbox;
  if (offer)
    document["upload"] = {{"limit", offer->limit_bytes}, {"token", offer->needs_token}};
  // Names of files may hold any bytes, JSON may not: the writer replaces those that are no UTF-8.
  return storage::json_text(document) + '\n';
}

Gallery::Gallery(Hierarchies& hierarchies, Clock clock)
    : hierarchies_(hierarchies), clock_(std::move(clock)) {}

void Gallery::refresh() {
  const std::lock_guard lock(mutex_);
  looked_.reset();
}

std::vector<Model> Gallery::models() {
  const std::lock_guard lock(mutex_);
  if (!looked_ || clock_() - *looked_ >= kFreshFor) {
    models_ = hierarchies_.list();
    looked_ = clock_();
  }
  return models_;
}

}  // namespace meshhier::server
