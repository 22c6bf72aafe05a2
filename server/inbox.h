// A folder into which mesh files are dropped: the files that are there, and whether they are whole.
#pragma once

#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::server {

/// The state of a mesh with all that belongs to it: another one as soon as anything is changed.
struct InputVersion {
  storage::FileVersion mesh;
  std::uint64_t companions = 0;  ///< storage::NotedFiles::mark()
  friend bool operator==(const InputVersion&, const InputVersion&) = default;
};

struct InboxFile {
  std::string name;  ///< "scan.ply", "house/scan.obj"
  InputVersion version;
  bool is_whole = false;
};

/// For one thread. Files are looked at, never changed.
class Inbox {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// A folder with one mesh file in it is a mesh, with all that belongs to it.
  enum class Folders { ignored, taken };
  struct Options {
    /// A file that has not changed for so long is whole. Many programs also give unfinished files
    /// endings of their own, which are no meshes' names.
    std::chrono::milliseconds settle{2000};
    Folders folders = Folders::ignored;
    /// Returns InputVersion::companions of a mesh, as far as they are known.
    std::function<std::uint64_t(const std::string& name)> mark = [](const std::string&) {
      return 0;
    };
    std::function<Time()> clock = std::chrono::steady_clock::now;
  };

  Inbox(std::filesystem::path directory, Options options);

  /// Returns the mesh files that are there now. One in a folder is whole when all files there are.
  /// Links are left out, and archives that hold hierarchies. Throws Error(io).
  std::vector<InboxFile> look();
  /// Returns the folders of the last look that give no model, and why, once they have been so for
  /// as long as files settle. Those of hierarchies, and hidden ones, are not told.
  const std::map<std::string, std::string>& left_out() const { return left_out_; }
  const std::filesystem::path& directory() const { return directory_; }
  /// Opens a file, without following it if it has become a link. Null if it is not there, or of
  /// another version. Throws Error(io).
  std::unique_ptr<storage::File> open(const std::string& name,
                                      const storage::FileVersion& version) const;

 private:
  struct Seen {
    InputVersion version;
    Time since;
    std::optional<bool> is_hierarchy{};  ///< an archive, if it was looked into
  };
  using SeenFiles = std::map<std::string, Seen>;

  Time note(const std::string& name, const InputVersion& version, Time now, SeenFiles& seen) const;
  static bool is_archived_hierarchy(const storage::Folder& inbox, const std::string& name,
                                    SeenFiles& seen);
  /// What was found in a folder: a mesh, or why there is none.
  struct FolderLook {
    std::optional<InboxFile> file{};
    std::string why_not{};
    Time since = Time::min();  ///< it has not changed
  };
  FolderLook look_into(const storage::Folder& inbox, const storage::FolderEntry& folder, Time now,
                       SeenFiles& seen) const;
  FolderLook look_at_ignored(const storage::Folder& inbox, const storage::FolderEntry& folder,
                             Time now, SeenFiles& seen) const;

  std::filesystem::path directory_;  ///< opened anew each time: it may be another one by then
  Options options_;
  SeenFiles seen_;
  std::map<std::string, std::string> left_out_;
};

}  // namespace meshhier::server
