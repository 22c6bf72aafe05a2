// Requests that change how a hierarchy is shown first:
//
//   PUT /models/scan.hier/view      a JSON object, as "view" in a config; {}: none
//
// Who may send meshes may do so (uploads.h). The rest of the hierarchy stays as it is.
#pragma once

#include "server/hierarchies.h"
#include "server/http.h"
#include "server/uploads.h"
#include "storage/io/file.h"

#include <filesystem>
#include <string_view>

namespace meshhier::server {

/// Takes such requests. Thread-safe.
class ViewRequests {
 public:
  /// `folder`: the one that is served, absolute. All else must outlive this; `tell` hears why a
  /// view could not be stored.
  ViewRequests(std::filesystem::path folder, const Uploads& uploads, Hierarchies& hierarchies,
               storage::FileSystem& files, Hierarchies::Tell tell);

  /// Whether a target is that of a view, as far as it says: "/models/scan.hier/view".
  static bool is_view(std::string_view target);

  /// Replies 200 with a JSON object, the `build`'s new name and the `view` as it is kept; or why
  /// not, in one line. Throws nothing but storage::Busy.
  Reply take(const Request& request);

 private:
  Reply replace(const Request& request, const std::string& path);

  std::filesystem::path folder_;
  const Uploads& uploads_;
  Hierarchies& hierarchies_;
  storage::FileSystem& files_;
  Hierarchies::Tell tell_;
};

}  // namespace meshhier::server
