#include "server/folder_scan.h"

#include "base/error.h"
#include "server/url_path.h"
#include "storage/format/layout.h"
#include "storage/io/paths.h"
#include "storage/io/system_failure.h"
#include "storage/io/zip_directory.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace meshhier::server {
namespace {

// Ten times as many as a large collection has; they are looked through within a few seconds.
constexpr std::size_t kMostDirectories = 100'000;

class Scanner {
 public:
  explicit Scanner(const storage::Folder& folder) : folder_(folder) {}

  FolderScan run() {
    waiting_.emplace_back();
    for (std::size_t count = 0; !waiting_.empty() && count < kMostDirectories; ++count) {
      const std::string directory = std::move(waiting_.back());
      waiting_.pop_back();
      look_into(directory);
    }
    scan_.is_complete = waiting_.empty();
    return std::move(scan_);
  }

 private:
  void look_into(const std::string& directory) {
    const std::vector<storage::FolderEntry> entries = entries_of(directory);
    if (std::any_of(entries.begin(), entries.end(), is_manifest))
      return scan_.hierarchies.push_back(directory);
    for (const storage::FolderEntry& entry : entries) {
      const std::string path = directory.empty() ? entry.name : directory + '/' + entry.name;
      if (decode_path('/' + encode_path(path)) != path)
        continue;
      if (entry.is_directory) {
        waiting_.push_back(path);
      } else if (is_archive_name(entry.name)) {
        scan_.hierarchies.push_back(path);
      }
    }
  }

  /// Lists a directory, or notes why it cannot be listed: one that others may not read (lost+found)
  /// or a disk has lost must not hide the rest.
  std::vector<storage::FolderEntry> entries_of(const std::string& directory) {
    try {
      return folder_.entries(directory);
    } catch (const storage::Busy&) {
      throw;
    } catch (const Error& error) {
      if (directory.empty())
        throw;
      scan_.failures.emplace_back(error.what());
      return {};
    }
  }

  static bool is_manifest(const storage::FolderEntry& entry) {
    return !entry.is_directory && entry.name == storage::manifest_path({});
  }

  const storage::Folder& folder_;
  FolderScan scan_;
  std::vector<std::string> waiting_;
};

}  // namespace

FolderScan scan_folder(const storage::Folder& folder) {
  return Scanner(folder).run();
}

std::string joined(const std::string& directory, const std::string& name) {
  return directory.empty() ? name : name.empty() ? directory : directory + '/' + name;
}

bool is_archive_name(std::string_view path) {
  return storage::lower_extension(path) == ".3tz";
}

bool is_hierarchy(std::shared_ptr<const storage::File> archive) {
  try {
    return storage::ZipDirectory(std::move(archive)).find(storage::manifest_path({}).string()) !=
           nullptr;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace meshhier::server
