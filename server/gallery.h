// models.json: what the page shows first.
#pragma once

#include "server/hierarchies.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::server {

/// What the page calls the folder that is served, and the one that is watched; empty: not told.
struct PlaceNames {
  std::string folder{};
  std::string inbox{};
};

/// What a page may send to the inbox.
struct UploadOffer {
  std::uint64_t limit_bytes = 0;
  bool needs_token = false;
};

/// The listing of a plain host, which hands out archives as they are, with a picture beside each.
std::string static_gallery_json(const std::vector<Model>& models);
/// Relative to the listing, as a path; requires model.has_story.
std::string story_beside(const Model& model);
/// Of an archive on a plain host, relative to the listing, as a path.
std::string picture_beside(const Model& model);

/// `jobs`: of a watched folder; none if none is watched, and then no build's warnings are told.
/// `offer`: none if no uploads are taken. Paths are relative to the document, as a URL has them.
std::string gallery_json(const std::vector<Model>& models,
                         const std::optional<nlohmann::ordered_json>& jobs,
                         const PlaceNames& places, const std::optional<UploadOffer>& offer = {});

/// Thread-safe.
class Gallery {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  explicit Gallery(Hierarchies& hierarchies, Clock clock = std::chrono::steady_clock::now);

  /// The models as they were at most a second ago. Throws Error(io).
  std::vector<Model> models();
  /// There is news: the next one who asks gets it.
  void refresh();

 private:
  Hierarchies& hierarchies_;
  Clock clock_;
  std::mutex mutex_;  ///< guards all below; whoever waits gets what the one before found
  std::vector<Model> models_;
  std::optional<std::chrono::steady_clock::time_point> looked_;
};

}  // namespace meshhier::server
