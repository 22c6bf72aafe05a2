// Read access to a 3TZ archive (storage/format/archive_format.h), nobody vouching for its bytes.
#pragma once

#include "storage/format/archive_format.h"
#include "storage/io/file.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Thread-safe once constructed.
/// Whether a file means to be an archive, whatever is in it. Throws Error(io).
bool is_archive(const File& file);

class Archive {
 public:
  /// Reads the directory, and checks that it is what ArchiveWriter makes: stored files, one behind
  /// the other, each name once, the index last. Holds 32 bytes a file. Throws Error(corrupt) naming
  /// the archive, Error(io).
  explicit Archive(std::unique_ptr<File> file);

  /// Where a file's content is.
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
  };
  std::optional<Place> find(std::string_view name) const;

  /// Visits all files in their order, the index last; reads the directory again.
  void for_each(const std::function<void(const ArchiveEntry&)>& visit) const;

  const File& file() const { return *file_; }
  const std::shared_ptr<const File>& shared_file() const { return file_; }
  std::uint64_t entry_count() const { return end_.entries; }

 private:
  struct Slot {
    IndexPlace place;  ///< with the offset of the content
    std::uint32_t bytes = 0;
  };

  std::shared_ptr<const File> file_;
  ArchiveEnd end_;
  std::vector<Slot> slots_;  ///< by name's MD5
};

/// Whether what lies there, a directory perhaps, begins as the archive of a hierarchy does: with a
/// manifest. Throws Error(io).
bool is_hierarchy_archive(FileSystem& files, const std::filesystem::path& path);

}  // namespace meshhier::storage
