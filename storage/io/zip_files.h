// 3D Tiles archives (3TZ) as folders: "town.3tz/tileset.json" is a file in town.3tz.
#pragma once

#include "storage/io/forwarding_files.h"
#include "storage/io/zip_directory.h"

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::storage {

/// Returns whether a file of that name is a 3D Tiles archive.
bool is_3tz_name(const std::filesystem::path& path);

/// Returns the archive in which a path lies: the file before it that is named so; nothing if there
/// is none.
std::optional<std::filesystem::path> archive_around(FileSystem& files,
                                                    const std::filesystem::path& path);

/// A file system in which files named .3tz are folders as well, for reading. What their directories
/// say is known as long as they do not change. The other one does all else. Thread-safe as far as
/// the other one is. Failures are those of ZipDirectory.
class ZipFiles final : public ForwardingFiles {
 public:
  using ForwardingFiles::ForwardingFiles;

  std::unique_ptr<File> open(const std::filesystem::path& path) override;
  FileIdentity identity(const std::filesystem::path& path) override;
  bool exists(const std::filesystem::path& path) override {
    return kind(path) != FileKind::none || others().exists(path);
  }
  FileKind kind(const std::filesystem::path& path) override;
  std::filesystem::path canonical(const std::filesystem::path& path) override;
  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override;
  std::vector<std::filesystem::path> children(const std::filesystem::path& directory) override;

 private:
  struct Known {
    FileIdentity identity;
    std::shared_ptr<const ZipDirectory> directory;
  };
  /// A path below an archive.
  struct Inner {
    std::filesystem::path archive;
    std::string name;  ///< of the file in it
  };
  std::optional<Inner> inner_of(const std::filesystem::path& path) const;
  std::shared_ptr<const ZipDirectory> directory_of(const std::filesystem::path& archive);

  std::mutex mutex_;
  std::map<std::filesystem::path, Known> known_;
};

}  // namespace meshhier::storage
