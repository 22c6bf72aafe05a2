// A file that is there complete or not at all.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace meshhier::storage {

/// Beside `file`: its name until it is whole.
std::filesystem::path unfinished_path(const std::filesystem::path& file);

class AtomicFile {
 public:
  /// Finds out whether `path` can be written, by making the file under a temporary name beside it.
  /// What is there under the name itself stays until publish(). Throws Error(io).
  AtomicFile(FileSystem& files, std::filesystem::path path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  /// Removes what was not published.
  ~AtomicFile();

  /// Writes `bytes`, forces them to the disk and gives the file its name. Throws Error(io).
  void publish(std::span<const std::byte> bytes);

  /// For who writes the file piece by piece: where, until publish() forces it to the disk and gives
  /// it its name.
  const std::filesystem::path& unfinished() const { return temporary_; }
  void publish();

 private:
  FileSystem& files_;
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::unique_ptr<File> file_;
};

}  // namespace meshhier::storage
