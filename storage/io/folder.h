// A directory to read from that no path leads out of. A server shows its files by it.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// A file or directory in a folder.
struct FolderEntry {
  std::string name;
  bool is_directory = false;
  FileVersion version;
};

/// A directory that is held open, and what is below it, for reading. No link is followed below it,
/// whoever makes one at whatever moment: nothing outside can be reached. Names are relative, with
/// '/' between their parts, of which none may be empty, "." or "..". Thread-safe.
class Folder {
 public:
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  virtual ~Folder() = default;

  const std::filesystem::path& path() const { return path_; }
  /// Whether path() still leads to this directory: another one may have been mounted or put there.
  virtual bool is_in_place() const = 0;

  /// Opens a file for reading; null if there is no regular file of that name, or the name is not
  /// allowed. The file may outlive the folder. Throws Error(io).
  virtual std::unique_ptr<File> open(std::string_view name) const = 0;
  /// Returns the regular files and directories directly in the directory of that name ("": this
  /// one), ascending by name; all else, links too, is left out. Empty if there is no such
  /// directory. Throws Error(io).
  virtual std::vector<FolderEntry> entries(std::string_view name) const = 0;

 protected:
  explicit Folder(std::filesystem::path path) : path_(std::move(path)) {}

 private:
  std::filesystem::path path_;
};

/// Opens a directory; `path` itself may be a link. Throws Error(io) if it is no directory.
std::unique_ptr<Folder> open_folder(const std::filesystem::path& path);

}  // namespace meshhier::storage
