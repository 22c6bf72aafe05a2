// A hierarchy in a 3TZ archive, read as if it were a directory of that name.
#pragma once

#include "storage/format/archive.h"
#include "storage/io/file.h"
#include "storage/io/forwarding_files.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Returns a file of an archive as a file of its own, for reading; its version is the archive's.
/// `path`: for messages. Requires that `place` lies in the archive, as Archive::find() tells it. It
/// keeps the archive open.
std::unique_ptr<File> open_archived(std::filesystem::path path, std::shared_ptr<const File> archive,
                                    Archive::Place place);

/// A file system in which an archive is a directory as well: its files can be opened, looked at and
/// listed. The other one does all else, and refuses to change what is below a file; so kind() and
/// children() know nothing of what is in the archive. Thread-safe as far as the other one is.
class ArchiveFiles final : public ForwardingFiles {
 public:
  /// Opens the archive; throws as Archive does. `others` must outlive this.
  ArchiveFiles(FileSystem& others, const std::filesystem::path& archive);

  const Archive& archive() const { return archive_; }

  std::unique_ptr<File> open(const std::filesystem::path& path) override;
  FileIdentity identity(const std::filesystem::path& path) override;
  bool exists(const std::filesystem::path& path) override;
  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override;
  bool can_list(const std::filesystem::path& directory) override;
  void will_read(std::span<const std::filesystem::path> files) override;

 private:
  /// Returns the name in the archive; nothing if the path leads elsewhere.
  std::optional<std::string> name_of(const std::filesystem::path& path) const;

  Archive archive_;
  std::string root_;  ///< with a slash at its end
};

/// The file system to read a hierarchy with: ArchiveFiles if its path is a file's, else the one
/// that is given.
class HierarchyFiles {
 public:
  /// Throws as Archive if there is a file that is no archive. `files` must outlive this.
  HierarchyFiles(FileSystem& files, const std::filesystem::path& hierarchy);

  FileSystem& files() const { return inside_ ? *inside_ : others_; }
  /// Null if it is a directory, or nothing.
  const Archive* archive() const { return inside_ ? &inside_->archive() : nullptr; }

 private:
  FileSystem& others_;
  std::unique_ptr<ArchiveFiles> inside_;
};

}  // namespace meshhier::storage
