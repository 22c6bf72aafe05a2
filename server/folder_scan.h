// Looks for hierarchies below a folder.
#pragma once

#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::server {

struct FolderScan {
  std::vector<std::string> hierarchies;  ///< paths that look like one; "": the folder itself
  std::vector<std::string> failures;     ///< why directories could not be looked into
  bool is_complete = true;               ///< false: there is too much to look at it all
};

/// Finds directories with a manifest, in which nothing else is looked for, and archives. Names that
/// no URL of ours can have, those that begin with a dot among them, are left out. Throws Error(io)
/// if the folder itself cannot be listed, and storage::Busy.
FolderScan scan_folder(const storage::Folder& folder);

/// Returns a path in a folder, "directory/name"; either part may be empty.
std::string joined(const std::string& directory, const std::string& name);

/// Whether a file of that name is taken for an archive.
bool is_archive_name(std::string_view path);

/// Returns whether an archive holds a hierarchy; false if it is broken.
bool is_hierarchy(std::shared_ptr<const storage::File> archive);

}  // namespace meshhier::server
