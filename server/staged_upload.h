// A file or folder on its way into an inbox has a name that nobody looks at until it is whole.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace meshhier::server {

/// Whatever ends an upload, it is there complete or not at all. For one thread.
class StagedUpload {
 public:
  /// Locks a name of its own in `inbox`. `files` must outlive this. Throws Error(io).
  StagedUpload(storage::FileSystem& files, std::filesystem::path inbox);
  StagedUpload(const StagedUpload&) = delete;
  StagedUpload& operator=(const StagedUpload&) = delete;
  /// Removes an upload that was not published.
  ~StagedUpload();

  /// The path where the file or the folder is to be made.
  const std::filesystem::path& path() const { return path_; }
  /// Gives it its name in the inbox, for good. Returns false if there is something of that name.
  /// Requires that the content at path() has been synced. Throws Error(io).
  bool publish(const std::string& name);

 private:
  storage::FileSystem& files_;
  std::filesystem::path inbox_, path_;
  std::unique_ptr<storage::FileLock> lock_;
};

/// Removes uploads whose server was killed; those under way are locked, and stay. Throws Error(io).
void remove_stale_uploads(storage::FileSystem& files, const std::filesystem::path& inbox);

}  // namespace meshhier::server
