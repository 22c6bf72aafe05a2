#include "server/gallery.h"

#include "server/folder_scan.h"
#include "server/url_path.h"
#include "storage/format/layout.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

/// The disk is asked once for all pages, each of which asks every few seconds.
constexpr std::chrono::seconds kFreshFor{1};
/// And for so many times as long as it takes: a tenth of a processor at the most.
constexpr int kRest = 10;

constexpr const char* kListingName = "models.json";
/// A listing of so many models is one file. Of more the first part fills a window or two, and the
/// others come behind it: a part has about 300 kB.
constexpr std::size_t kMostInOne = 500, kFirstPart = 120, kPart = 1000;
constexpr std::size_t kMostListedTags = 100;  // that a listing tells

using Json = nlohmann::ordered_json;

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

Json json_of(const Model& model) {
  Json json{{"name", model.name},           {"path", url_of(model)}, {"vertices", model.vertices},
            {"triangles", model.triangles}, {"bytes", model.bytes},  {"source", model.source}};
  if (model.modified > 0)
    json["modified"] = model.modified;
  if (model.has_preview)
    json["preview"] = directory_of(model) + storage::preview_path({}).string();
  if (model.has_story)
    json["story"] = encode_path(story_beside(model));
  if (!model.title.empty())
    json["title"] = model.title;
  if (!model.folder.empty())
    json["folder"] = model.folder;
  if (!model.tags.empty())
    json["tags"] = model.tags;
  if (model.place)
    json["place"] = {model.place->longitude, model.place->latitude};
  return json;
}

/// A plain host hands out archives as they are.
Json static_json_of(const Model& model) {
  Json json = json_of(model);
  if (!is_archive_name(model.path))
    return json;
  json["path"] = "models/" + encode_path(model.path);
  if (model.has_preview)
    json["preview"] = encode_path(picture_beside(model));
  return json;
}

/// Names of files may hold any bytes, JSON may not: the writer replaces those that are no UTF-8.
std::string text_of(const Json& document) {
  return storage::json_text(document) + '\n';
}

}  // namespace

std::string story_beside(const Model& model) {
  return "models/" + storage::story_path(model.path).generic_string();
}

std::string picture_beside(const Model& model) {
  return "models/" + model.path + ".webp";
}

std::vector<ListingFile> static_gallery_json(const std::vector<Model>& models) {
  std::vector<Json> listed;
  for (const Model& model : models)
    listed.push_back(static_json_of(model));
  if (listed.size() <= kMostInOne)
    return {{kListingName, storage::json_text(Json{{"models", listed}}, {.indent = 2}) + '\n'}};
  std::vector<ListingFile> files(1);
  Json names = Json::array();
  for (std::size_t at = kFirstPart; at < listed.size(); at += kPart) {
    const std::span part(listed.begin() + at, std::min(kPart, listed.size() - at));
    files.push_back({fmt::format("listing/{}.json", files.size()), text_of({{"models", part}})});
    names.push_back(files.back().path);
  }
  files[0] = {kListingName, text_of({{"models", std::span(listed).first(kFirstPart)},
                                     {"total", listed.size()},
                                     {"parts", names}})};
  return files;
}

namespace {

/// Counts what a wish finds by folder, in the order of folders.
Json groups_of(const Catalogue& catalogue, const std::vector<std::uint32_t>& found) {
  Json groups = Json::array();
  for (const std::uint32_t i : found) {
    const std::string_view folder = folder_of(catalogue.models()[i]);
    if (groups.empty() || groups.back()["folder"].get_ref<const std::string&>() != folder)
      groups.push_back({{"folder", folder}, {"count", 0}});
    groups.back()["count"] = groups.back()["count"].get<std::size_t>() + 1;
  }
  return groups;
}

/// Returns the place of each model found that has one: longitude, latitude and its number.
Json places_of(const Catalogue& catalogue, const std::vector<std::uint32_t>& found) {
  constexpr double kSteps = 1e6;  // of a degree: 10 cm
  Json places = Json::array();
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (const auto& place = catalogue.models()[found[i]].place)
      places.push_back({std::round(place->longitude * kSteps) / kSteps,
                        std::round(place->latitude * kSteps) / kSteps, i});
  }
  return places;
}

/// Adds what a part of a listing tells of the whole.
void add_whole(const Catalogue& catalogue, const ListingWish& wish,
               const std::vector<std::uint32_t>& found, Json& document) {
  document["total"] = catalogue.models().size();
  document["found"] = found.size();
  document["first"] = wish.first;
  document["state"] = catalogue.state();
  if (wish.first > 0)
    return;
  document["placed"] = std::ranges::count_if(
      found, [&](std::uint32_t i) { return catalogue.models()[i].place.has_value(); });
  if (wish.order == ModelOrder::folder)
    document["groups"] = groups_of(catalogue, found);
  document["tags"] = Json::array();
  for (const auto& [tag, count] : catalogue.tags(found, kMostListedTags))
    document["tags"].push_back({{"tag", tag}, {"count", count}});
}

void add_surroundings(const Surroundings& around, Json& document) {
  if (around.jobs)
    document["jobs"] = *around.jobs;
  if (!around.places.folder.empty())
    document["folder"] = around.places.folder;
  if (!around.places.inbox.empty())
    document["inbox"] = around.places.inbox;
  if (!around.offer)
    return;
  document["upload"] = {{"limit", around.offer->limit_bytes}, {"token", around.offer->needs_token}};
  if (around.offer->takes_views)
    document["upload"]["views"] = true;
}

}  // namespace

std::string gallery_json(const Catalogue& catalogue, const std::optional<ListingWish>& wish,
                         const Surroundings& around) {
  Json document{{"models", Json::array()}};
  const auto add = [&](const Model& model) {
    Json json = json_of(model);
    if (around.jobs && !model.warnings.empty())
      json["warnings"] = model.warnings;
    document["models"].push_back(std::move(json));
  };
  if (!wish) {
    std::ranges::for_each(catalogue.models(), add);
    add_surroundings(around, document);
    return text_of(document);
  }
  const std::vector<std::uint32_t> found = catalogue.find(*wish);
  const std::size_t first = std::min(wish->first, found.size());
  for (const std::uint32_t i :
       std::span(found).subspan(first, std::min(wish->count, found.size() - first)))
    add(catalogue.models()[i]);
  add_whole(catalogue, *wish, found, document);
  if (wish->wants_places)
    document["places"] = places_of(catalogue, found);
  add_surroundings(around, document);
  return text_of(document);
}

Gallery::Gallery(Hierarchies& hierarchies, Clock clock)
    : hierarchies_(hierarchies), clock_(std::move(clock)) {}

void Gallery::refresh() {
  const std::lock_guard lock(mutex_);
  looked_.reset();
}

std::shared_ptr<const Catalogue> Gallery::catalogue(const std::string& state) {
  const std::lock_guard lock(mutex_);
  if (catalogue_ && !state.empty() && catalogue_->state() == state)
    return catalogue_;
  const auto now = clock_();
  if (!looked_ || now - *looked_ >= fresh_for_) {
    std::vector<Model> models = hierarchies_.list();
    if (!catalogue_ || models != catalogue_->models())
      catalogue_ = std::make_shared<const Catalogue>(std::move(models));
    looked_ = clock_();
    fresh_for_ = std::max<std::chrono::steady_clock::duration>(kFreshFor, kRest * (*looked_ - now));
  }
  return catalogue_;
}

}  // namespace meshhier::server
