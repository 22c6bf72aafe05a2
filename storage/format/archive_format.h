// The bytes of a 3TZ archive that are not its files' contents (docs/file_format.md, section 7): a
// zip file (PKWARE's APPNOTE 6.3.9) of stored files, and what the 3D Tiles Archive Format 1.3 adds.
//
// clang-format off
//   for each file       local header 30 + n, content     n: bytes of its name; no gap, no overlap
//   @3dtilesIndex1@     local header 45, for each other file its name's MD5 and u64 offset of its local header
//   for each file       central header 46 + n            12 more from an offset of 4 GiB - 1 on
//   end                 22, or 98 with zip64's records   where a count or offset does not fit
//
//   local header        u32 0x04034b50, u16 version needed, u16 flags 0, u16 method 0, u16 time 0, u16 date 0x21,
//                       u32 CRC-32, u32 bytes, u32 bytes, u16 n, u16 0, name
//   central header      u32 0x02014b50, u16 made by 45, version to date and CRC-32 to n as above, u16 extra bytes, u16 0,
//                       u16 0, u16 0, u32 0, u32 offset, name, perhaps u16 1, u16 8, u64 offset
//   zip64's end         u32 0x06064b50, u64 44, u16 45, u16 45, u32 0, u32 0, u64 files, u64 files, u64 bytes of all
//                       central headers, u64 offset of the first; u32 0x07064b50, u32 0, u64 offset of this, u32 1
//   end                 u32 0x06054b50, u16 0, u16 0, u16 files, u16 files, u32 bytes, u32 offset, u16 0
// clang-format on
//
// Nothing is left open: these bytes follow from the names, sizes and CRC-32s of the files in their
// order. A reader makes them again and compares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// A file in an archive.
struct ArchiveEntry {
  std::string name;
  std::uint64_t offset = 0;  ///< where its local header begins
  std::uint32_t bytes = 0;
  std::uint32_t crc = 0;

  std::uint64_t content() const;  ///< offset of its content
  std::uint64_t end() const { return content() + bytes; }
};

/// The index of 3D Tiles, the last file.
inline constexpr std::string_view kArchiveIndexName = "@3dtilesIndex1@";

inline constexpr std::size_t kLocalHeaderBytes = 30;
inline constexpr std::size_t kCentralHeaderBytes = 46;
/// The most bytes of a name that is written or read; those of a hierarchy have 30 at most.
inline constexpr std::size_t kLongestArchiveName = 255;
inline constexpr std::size_t kLongestCentralHeader = kCentralHeaderBytes + kLongestArchiveName + 12;
inline constexpr std::size_t kLongestArchiveEnd = 98;
/// Sizes in local headers have 32 bits, of which all ones say something else.
inline constexpr std::uint64_t kMostFileBytes = 0xfffffffe;

/// Whether it is a relative path of printable ASCII without spaces, of at most kLongestArchiveName
/// bytes, that leads nowhere but below: "a/b.c", not "/a", "../a", "a//b" or "a\b".
bool is_archive_name(std::string_view name);

void append_local_header(std::vector<std::byte>& bytes, const ArchiveEntry& entry);
void append_central_header(std::vector<std::byte>& bytes, const ArchiveEntry& entry);

/// Returns the entry of a local header, which is not checked any further; `bytes` begin with it and
/// end with its name or later. Throws Error(corrupt) that starts with `name`.
ArchiveEntry parse_local_header(std::span<const std::byte> bytes, std::uint64_t offset,
                                const std::string& name);

/// An entry out of the directory.
struct CentralHeader {
  ArchiveEntry entry;
  std::size_t bytes = 0;  ///< size of the header
};
/// Parses the central header that `bytes` begin with, of the entry at `offset`, which is where the
/// entry before ended. Throws Error(corrupt) that starts with `name` if it is not what
/// append_central_header() makes.
CentralHeader parse_central_header(std::span<const std::byte> bytes, std::uint64_t offset,
                                   const std::string& name);

struct ArchiveEnd {
  std::uint64_t entries = 0;          ///< the index among them
  std::uint64_t directory = 0;        ///< offset of the first central header
  std::uint64_t directory_bytes = 0;  ///< bytes of all central headers
};
std::vector<std::byte> encode_archive_end(const ArchiveEnd& end);
/// Parses the end of an archive. `last`: the last kLongestArchiveEnd bytes of a file of
/// `file_bytes`, or all of it. Throws Error(corrupt) that starts with `name` if they do not end
/// with what encode_archive_end() makes, or do not fit the file's size.
ArchiveEnd parse_archive_end(std::span<const std::byte> last, std::uint64_t file_bytes,
                             const std::string& name);

/// Whether a file that begins with `first` and ends with `last` means to be a zip file.
bool looks_like_archive(std::span<const std::byte> first, std::span<const std::byte> last);

/// A place in the index is the MD5 of a name, then the u64 offset of its local header.
using IndexPlace = std::array<std::byte, 24>;
IndexPlace index_place(std::string_view name, std::uint64_t offset);
/// Whether `a` stands before `b` in the index, which ascends by the MD5s as two u64 each; of two
/// places of one name neither does, whatever their offsets.
bool comes_before(const IndexPlace& a, const IndexPlace& b);

}  // namespace meshhier::storage
