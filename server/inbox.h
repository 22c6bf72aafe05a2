// A folder into which mesh files are dropped: which there are, and which are whole.
#pragma once

#include "storage/io/file.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::server {

/// What tells a mesh with all that belongs to it from what it was before.
struct InputVersion {
  storage::FileVersion mesh;
  std::uint64_t companions = 0;  ///< Companions::mark()
  friend bool operator==(const InputVersion&, const InputVersion&) = default;
};

struct InboxFile {
  std::string name;
  InputVersion version;
  bool is_whole = false;
};

/// Of one thread. Files are looked at, never changed.
class Inbox {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;
  /// InputVersion::companions of a mesh, as far as they are known.
  using Mark = std::function<std::uint64_t(const std::string& name)>;

  /// `settle`: a file that was as it is for so long is whole. Copies of others often say so by
  /// their names as well: with the endings that browsers and programs give unfinished ones, they
  /// are no meshes' names.
  Inbox(
      std::filesystem::path directory, std::chrono::milliseconds settle,
      Mark mark = [](const std::string&) { return 0; },
      Clock clock = std::chrono::steady_clock::now);

  /// The mesh files that are there now, by name. Links are left out. Throws Error(io).
  std::vector<InboxFile> look();
  /// That file as it is now, not followed if it has become a link. Null if it is not there, or of
  /// another version. Throws Error(io).
  std::unique_ptr<storage::File> open(const std::string& name,
                                      const storage::FileVersion& version) const;

 private:
  struct Seen {
    InputVersion version;
    std::chrono::steady_clock::time_point since;
  };

  std::filesystem::path directory_;  ///< opened anew each time: it may be another one by then
  std::chrono::milliseconds settle_;
  Mark mark_;
  Clock clock_;
  std::map<std::string, Seen> seen_;
};

}  // namespace meshhier::server
