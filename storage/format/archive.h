// Read access to a 3TZ archive (storage/format/archive_format.h). Nobody vouches for its bytes.
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

/// Whether a file means to be an archive, whatever is in it. Throws Error(io).
bool is_archive(const File& file);

/// An archive whose directory is known. Thread-safe once constructed, as far as its file is.
class Archive {
 public:
  /// Reads the directory, and checks that it is what ArchiveWriter makes: stored files, one behind
  /// the other, each name once, the index last. Contents are not read. Keeps 28 bytes a file.
  /// Throws Error(corrupt) naming the archive, Error(io) if it cannot be read or is no archive at
  /// all.
  explicit Archive(std::unique_ptr<File> file);

  /// The place of a file's content in the archive; it lies within it.
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
  };
  /// Returns nothing if there is no file of that name. O(log n).
  std::optional<Place> find(std::string_view name) const;

  /// Visits all files in their order, the index last; reads the directory again. Throws as the
  /// constructor, and what `visit` throws.
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
  std::vector<Slot> slots_;  ///< sorted by the MD5 of names
};

/// Whether the path is a file that begins as the archive of a hierarchy does, with a manifest;
/// false for a directory and for nothing. Throws Error(io).
bool is_hierarchy_archive(FileSystem& files, const std::filesystem::path& path);

}  // namespace meshhier::storage
