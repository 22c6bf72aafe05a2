// A folder into which mesh files are dropped: which there are, and which are whole.
#pragma once

#include "storage/io/file.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::server {

struct InboxFile {
  std::string name;  ///< "scan.ply", "house/scan.obj"
  storage::FileVersion version;
  bool is_whole = false;
};

/// Of one thread. Files are looked at, never changed.
class Inbox {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Clock = std::function<Time()>;
  /// A folder with one mesh file in it is a mesh, with all that belongs to it.
  enum class Folders { ignored, taken };

  /// `settle`: a file that was as it is for so long is whole. Copies of others often say so by
  /// their names as well: with the endings that browsers and programs give unfinished ones, they
  /// are no meshes' names.
  Inbox(std::filesystem::path directory, std::chrono::milliseconds settle,
        Folders folders = Folders::ignored, Clock clock = std::chrono::steady_clock::now);

  /// The mesh files that are there now. One in a folder is whole when all files there are. Links
  /// are left out. Throws Error(io).
  std::vector<InboxFile> look();
  /// That file as it is now, not followed if it has become a link. Null if it is not there, or of
  /// another version. Throws Error(io).
  std::unique_ptr<storage::File> open(const std::string& name,
                                      const storage::FileVersion& version) const;

 private:
  struct Seen {
    storage::FileVersion version;
    Time since;
  };
  using SeenFiles = std::map<std::string, Seen>;

  Time note(const std::string& name, const storage::FileVersion& version, Time now,
            SeenFiles& seen) const;
  std::optional<InboxFile> look_into(const storage::Folder& inbox, const std::string& folder,
                                     Time now, SeenFiles& seen) const;

  std::filesystem::path directory_;  ///< opened anew each time: it may be another one by then
  std::chrono::milliseconds settle_;
  Folders folders_;
  Clock clock_;
  SeenFiles seen_;
};

}  // namespace meshhier::server
