// A file or folder on its way into an inbox: under a name that nobody looks at until it is whole.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace meshhier::server {

/// Whatever ends it, it is there complete or not at all. Of one thread.
class StagedUpload {
 public:
  /// `files` must outlive this. Throws Error(io).
  StagedUpload(storage::FileSystem& files, std::filesystem::path inbox);
  StagedUpload(const StagedUpload&) = delete;
  StagedUpload& operator=(const StagedUpload&) = delete;
  /// Removes what was not published.
  ~StagedUpload();

  /// Where the file or the folder is to be made.
  const std::filesystem::path& path() const { return path_; }
  /// Gives it its name in the inbox, for good. False if there is something of that name. Requires
  /// that what is at path() has been synced. Throws Error(io).
  bool publish(const std::string& name);

 private:
  storage::FileSystem& files_;
  std::filesystem::path inbox_, path_;
  std::unique_ptr<storage::FileLock> lock_;
};

/// Removes what uploads left whose server was killed; those under way are locked, and stay. Throws
/// Error(io).
void remove_stale_uploads(storage::FileSystem& files, const std::filesystem::path& inbox);

}  // namespace meshhier::server
