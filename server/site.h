// What is answered to which request: the page, the list of models, their files; nothing else.
#pragma once

#include "server/gallery.h"
#include "server/hierarchies.h"
#include "server/http.h"
#include "server/uploads.h"
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
  std::string missing_viewer{};                     ///< what "/" says then
  bool is_loopback = true;  ///< requests must name this machine by its loopback
  std::string cors{};       ///< an origin, or "*"; empty: pages of others may not read
  PlaceNames places{};
  Uploads* uploads = nullptr;  ///< null: none are taken; must outlive the site
};

/// Thread-safe.
class Site {
 public:
  /// The jobs of a watched folder, as in models.json.
  using Jobs = std::function<nlohmann::ordered_json()>;

  /// `hierarchies` must outlive this; `jobs` may be empty; `tell` hears what people at the terminal
  /// are to know.
  Site(SiteOptions options, Hierarchies& hierarchies, Jobs jobs, Hierarchies::Tell tell);

  /// Never throws: what fails is a reply, too.
  Reply answer(const Request& request);

  /// A hierarchy has appeared: from now on it is listed.
  void refresh() { gallery_.refresh(); }

 private:
  Reply route(const Request& request);
  const char* methods() const;
  bool is_upload(const Request& request) const;
  Reply models_json(const Request& request);
  Reply model_file(const Request& request, std::string_view path);
  Reply viewer_file(const Request& request, const std::string& path);
  void tell_busy(const std::string& cause);
  void add_common_headers(Reply& reply) const;

  SiteOptions options_;
  Jobs jobs_;
  Hierarchies::Tell tell_;
  Hierarchies& hierarchies_;
  Gallery gallery_;
  std::atomic<bool> told_busy_{false};
};

}  // namespace meshhier::server
