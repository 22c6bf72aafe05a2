// The directory a hierarchy is built in: beside the output, complete before it takes the output's
// name.
#pragma once

#include "storage/file.h"

#include <filesystem>

namespace meshhier::storage {

/// Whether there is an output. Throws Error(exists) if there is and `replace` is false, or if it is
/// no hierarchy; `state` says how it comes to be there.
bool check_output(FileSystem& files, const std::filesystem::path& output, bool replace,
                  const char* state = "is already there");

class WorkDirectory {
 public:
  /// Makes the work directory, in place of one an earlier, killed build left. Throws Error(exists)
  /// if `output` is there and `replace` is false, Error(io) if its parent cannot be written.
  WorkDirectory(FileSystem& files, std::filesystem::path output, bool replace);
  WorkDirectory(const WorkDirectory&) = delete;
  WorkDirectory& operator=(const WorkDirectory&) = delete;
  /// Removes the directory and all in it, and directories made above it, unless published.
  ~WorkDirectory();

  const std::filesystem::path& path() const { return path_; }  ///< of the hierarchy to be
  const std::filesystem::path& temporary() const {
    return temporary_;
  }  ///< for scratch files, within path()

  /// Removes the scratch files, syncs, and renames to the output; a hierarchy that is replaced
  /// keeps its name until then.
  void publish();

 private:
  FileSystem& files_;
  std::filesystem::path output_;
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::filesystem::path
      made_parent_;  ///< the topmost directory above the output that was not there before
  bool replace_;
  bool published_ = false;
};

}  // namespace meshhier::storage
