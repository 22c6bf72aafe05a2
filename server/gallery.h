// models.json, the list of models that the page shows first.
#pragma once

#include "server/catalogue.h"
#include "server/hierarchies.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::server {

/// The page's names for the folder that is served, and for the one that is watched; empty: not
/// told.
struct PlaceNames {
  std::string folder{};
  std::string inbox{};
};

/// What a page may send: meshes to the inbox, and more.
struct UploadOffer {
  std::uint64_t limit_bytes = 0;
  bool needs_token = false;
  bool takes_views = false;  ///< first views of models, too
};

/// A file of a site, at a path relative to its listing.
struct ListingFile {
  std::string path;
  std::string text;
};
/// Returns the listing of a plain host, which hands out archives as they are, with a picture beside
/// each: "models.json", and behind it its further parts where there are many models.
std::vector<ListingFile> static_gallery_json(const std::vector<Model>& models);
/// Returns the path of a model's story, relative to the listing. Requires model.has_story.
std::string story_beside(const Model& model);
/// Returns the path of an archive's picture on a plain host, relative to the listing.
std::string picture_beside(const Model& model);

/// What a server's listing tells besides the models. `jobs`: the watched folder's; none if none is
/// watched, and then no build's warnings are told. `offer`: none if no uploads are taken.
struct Surroundings {
  std::optional<nlohmann::ordered_json> jobs{};
  PlaceNames places{};
  std::optional<UploadOffer> offer{};
};

/// Returns the listing of a server: all models, or what a wish asks for. Paths are relative to the
/// document, as a URL has them.
std::string gallery_json(const Catalogue& catalogue, const std::optional<ListingWish>& wish,
                         const Surroundings& around);

/// The models of a folder, listed at most once a second, and less often where that takes long.
/// Thread-safe.
class Gallery {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  explicit Gallery(Hierarchies& hierarchies, Clock clock = std::chrono::steady_clock::now);

  /// Returns the models as they were at most a second ago, or ten times as long as it takes to look
  /// at them; `state`: as they were when their catalogue had that name, if it still is remembered.
  /// Throws Error(io).
  std::shared_ptr<const Catalogue> catalogue(const std::string& state = {});
  /// Says that there is news: the next one who asks gets it.
  void refresh();

 private:
  Hierarchies& hierarchies_;
  Clock clock_;
  std::mutex mutex_;  ///< guards all below; whoever waits gets what the one before found
  std::shared_ptr<const Catalogue> catalogue_;
  std::optional<std::chrono::steady_clock::time_point> looked_;
  std::chrono::steady_clock::duration fresh_for_{};
};

}  // namespace meshhier::server
