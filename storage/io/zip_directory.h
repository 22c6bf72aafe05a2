// The files in a zip archive of anybody's (PKWARE's APPNOTE 6.3.9), such as a 3D Tiles archive
// (3TZ).
//
// The directory at the end of the archive is read once. From the end backwards:
//
//   end of directory  "PK\5\6"  files u16 at 10, bytes u32 at 12, offset u32 at 16,
//                               comment u16 at 20
//   its zip64 locator "PK\6\7"  right before it: offset u64 at 8 of
//   zip64's end       "PK\6\6"  files u64 at 32, bytes u64 at 40, offset u64 at 48
//   directory         "PK\1\2"  a header of 46 bytes a file: flags u16 at 8, method u16 at 10,
//                               CRC-32 at 16, packed u32 at 20, bytes u32 at 24, lengths u16 of
//                               name, extra and comment at 28, offset u32 at 42; then these.
//                               Extra 1 has u64s where a number is all ones
//   before each file  "PK\3\4"  30 bytes, lengths of name and extra at 26; then these, then
//                               the content
//
// The directory alone counts: indexes that archives hold as files, as 3TZ has one, are not read.
//
// Cost. 40 bytes of memory a file, and its name.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

struct ZipEntry {
  std::uint64_t header = 0;             ///< where its local header begins
  std::uint64_t packed = 0, bytes = 0;  ///< bytes in the archive, and unpacked
  std::uint32_t crc = 0;
  std::uint32_t name_at = 0;  ///< ZipDirectory::name_of() returns the name
  std::uint16_t name_bytes = 0;
  std::uint16_t flags = 0, method = 0;
};

/// A zip archive whose directory is known. Thread-safe once constructed, as far as its file is.
class ZipDirectory {
 public:
  /// The most bytes of the directory, and of a file that is packed.
  static constexpr std::uint64_t kMostDirectory = std::uint64_t{256} << 20;
  static constexpr std::uint64_t kMostPacked = std::uint64_t{256} << 20;

  /// Throws Error(input) naming the archive if it is no zip file, broken or larger, or has two
  /// different files of one name; Error(io).
  explicit ZipDirectory(std::shared_ptr<const File> archive);

  /// Returns the name without "./" before it, and with "/" between folders.
  std::string_view name_of(const ZipEntry& entry) const {
    return std::string_view(names_).substr(entry.name_at, entry.name_bytes);
  }
  /// Returns null if there is no file of that name. O(log n).
  const ZipEntry* find(std::string_view name) const;
  /// Returns the files whose names begin so, ascending.
  std::span<const ZipEntry> starting_with(std::string_view start) const;

  /// Opens a file for reading, as open_zip_content(); `path` is its name in messages. It keeps the
  /// archive open. Throws Error(input) if it is damaged, encrypted, or packed otherwise than by
  /// Deflate or Zstandard, or to more than kMostPacked; Error(io).
  std::unique_ptr<File> open(const ZipEntry& entry, const std::filesystem::path& path) const;

  const File& file() const { return *file_; }

 private:
  std::size_t take_entries(std::span<const std::byte> block);
  void require_one_of_each();

  std::shared_ptr<const File> file_;
  std::vector<ZipEntry> entries_;  ///< ascending by name
  std::string names_;
};

}  // namespace meshhier::storage
