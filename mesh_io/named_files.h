// Files that a mesh file names: its material libraries and pictures.
//
// A name is a path from the folder of the file that names it. Its backslashes are slashes, as files
// come from Windows; what is not there as written is looked for without regard to the case of
// letters, and taken if one file alone fits. A path that leads to nothing is looked for by its last
// part, beside the file that names it: folders of another machine are not there. Only regular files
// are found.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Whether the system can have a file of that path; what asks for another one fails.
bool is_possible(const std::filesystem::path& path);

/// Where NamedFiles::find() looks, as the name is written: there, and beside the file that names
/// it.
std::vector<std::filesystem::path> sought_places(const std::filesystem::path& folder,
                                                 std::string_view name);

class NamedFiles {
 public:
  explicit NamedFiles(storage::FileSystem& files) : files_(files) {}

  /// The file that `name` means in a file of `folder`; none if there is none. A name that is
  /// followed by a comment (" #") is one if it is no file with it. Throws Error(io).
  std::optional<std::filesystem::path> find(const std::filesystem::path& folder,
                                            std::string_view name);
  storage::FileSystem& files() const { return files_; }

 private:
  using Path = std::filesystem::path;
  /// Names in a folder, by the same in small letters.
  using Names = std::multimap<std::string, std::string>;

  std::optional<Path> find_written(const Path& folder, const std::string& name);
  std::optional<Path> find_any_case(Path folder, const Path& name);
  bool is_file(const Path& path) const { return files_.kind(path) == storage::FileKind::regular; }
  const Names& names_in(const Path& folder);

  storage::FileSystem& files_;
  std::map<Path, Names> folders_;  ///< those that were looked into
};

}  // namespace meshhier::mesh_io
