// A folder beside an output, for the files that it is made of; `meshhier clean` knows its name.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <memory>

namespace meshhier::storage {

class WorkFolder {
 public:
  /// Makes and locks it. Throws Error(io).
  WorkFolder(FileSystem& files, const std::filesystem::path& output);
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  /// Removes it with all that is in it.
  ~WorkFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  FileSystem& files_;
  std::filesystem::path path_;
  std::unique_ptr<FileLock> lock_;
};

}  // namespace meshhier::storage
