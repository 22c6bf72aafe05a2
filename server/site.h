// The replies to requests: the page, the list of models, their files; nothing else.
#pragma once

#include "server/gallery.h"
#include "server/hierarchies.h"
#include "server/http.h"
#include "server/uploads.h"
#include "server/view_requests.h"
#include "server/vitals.h"
#include "storage/io/folder.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace meshhier::server {

struct SiteOptions {
  std::shared_ptr<const storage::Folder> viewer{};  ///< the page's files; null: they are not there
  std::string missing_viewer{};                     ///< the reply to "/" then
  bool is_loopback = true;  ///< requests must name this machine by its loopback
  std::string cors{};       ///< an origin whose pages may read, or "*"; empty: none but ours
  std::string frame{};      ///< an origin whose pages may show ours in a frame, or "*"; empty: ours
  PlaceNames places{};
  Uploads* uploads = nullptr;     ///< null: none are taken; must outlive the site
  ViewRequests* views = nullptr;  ///< likewise
  Vitals* vitals = nullptr;       ///< null: nobody is told; must outlive the site
};

/// Makes the reply to each request. Thread-safe.
class Site {
 public:
  /// Returns the jobs of a watched folder, as in models.json.
  using Jobs = std::function<nlohmann::ordered_json()>;

  /// `hierarchies` must outlive this; `jobs` may be empty; `tell` hears messages for people at the
  /// terminal. Both are called by any thread that asks.
  Site(SiteOptions options, Hierarchies& hierarchies, Jobs jobs, Hierarchies::Tell tell);

  /// Replies to a request. Never throws: a failure is a reply, too: 503 and Retry-After if it may
  /// pass, else 500, without names of this machine; the terminal hears why. Caches may keep no
  /// reply from 400 on. Files and the list have an ETag, so that a client which asks again gets
  /// 304. A file of a model belongs to the build that the query names ("build"), else the reply is
  /// 409. Only uploads may have a body.
  Reply answer(const Request& request);

  /// Says that a hierarchy has appeared: from now on it is listed.
  void refresh() { gallery_.refresh(); }

  /// Returns how many models there were at the last look, at most a second ago or as Gallery says.
  /// Throws Error(io) if they cannot be listed.
  std::size_t model_count() { return gallery_.catalogue()->models().size(); }

 private:
  Reply route(const Request& request);
  const char* methods(std::string_view target) const;
  bool is_upload(const Request& request) const;
  bool is_vital(const Request& request) const;
  Reply take_view(const Request& request);
  Reply models_json(const Request& request);
  Reply model_file(const Request& request, std::string_view path);
  Reply viewer_file(const Request& request, const std::string& path);
  void tell_busy(const std::string& cause);
  std::string policy(std::string_view directives) const;
  void add_safety_headers(Reply& reply) const;
  void add_cors_headers(Reply& reply) const;

  SiteOptions options_;
  Jobs jobs_;
  Hierarchies::Tell tell_;
  Hierarchies& hierarchies_;
  Gallery gallery_;
  std::atomic<bool> told_busy_{false};
};

}  // namespace meshhier::server
