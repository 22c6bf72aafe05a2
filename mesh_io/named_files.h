// Files that a mesh file names: its material libraries and pictures.
//
// A name is a path from the folder of the file that names it. Its backslashes are slashes, as files
// come from Windows; a file that is not there as written is looked for without regard to the case
// of letters, and taken if one file alone fits. A path that leads to nothing is looked for by its
// last part, beside the file that names it: folders of another machine are not there. Only regular
// files are found.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Returns whether the system can have a file of that path; asking it for another one fails.
bool is_possible(const std::filesystem::path& path);

/// Returns the places where NamedFiles::find() looks for a name as it is written: at the name's
/// path, and beside the file that names it.
std::vector<std::filesystem::path> sought_places(const std::filesystem::path& folder,
                                                 std::string_view name);

/// Finds files by names. It remembers the folders that it has looked into. For one thread.
class NamedFiles {
 public:
  explicit NamedFiles(storage::FileSystem& files) : files_(files) {}

  /// Returns the file that `name` means in a file of `folder`; none if there is none. A name may be
  /// followed by a comment (" #"), if no file has a name with it. Throws Error(io).
  std::optional<std::filesystem::path> find(const std::filesystem::path& folder,
                                            std::string_view name);
  storage::FileSystem& files() const { return files_; }

 private:
  using Path = std::filesystem::path;
  /// Names in a folder, each by its small letters.
  using Names = std::multimap<std::string, std::string>;

  std::optional<Path> find_written(const Path& folder, const std::string& name);
  std::optional<Path> find_any_case(Path folder, const Path& name);
  bool is_file(const Path& path) const { return files_.kind(path) == storage::FileKind::regular; }
  const Names& names_in(const Path& folder);

  storage::FileSystem& files_;
  std::map<Path, Names> folders_;  ///< those that were looked into
};

}  // namespace meshhier::mesh_io
