#include "storage/format/archive_format.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/format/glb.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

constexpr std::uint32_t kLocalMark = 0x04034b50;
constexpr std::uint32_t kCentralMark = 0x02014b50;
constexpr std::uint32_t kEndMark = 0x06054b50;
constexpr std::uint32_t kZip64EndMark = 0x06064b50;
constexpr std::uint32_t kZip64LocatorMark = 0x07064b50;

constexpr std::size_t kEndBytes = 22;
constexpr std::size_t kZip64EndBytes = 56;

constexpr std::uint16_t kPlainVersion = 10;  // stored files
constexpr std::uint16_t kZip64Version = 45;
constexpr std::uint16_t kFirstDay = 0x21;  // 1980-01-01, the first that DOS knows

// A number that does not fit is written as all ones, and once more in zip64's records.
constexpr std::uint64_t kTooMany = 0xffff;
constexpr std::uint64_t kTooLong = 0xffffffff;
constexpr std::uint16_t kZip64Extra = 1;

bool is_far(const ArchiveEntry& entry) {
  return entry.offset >= kTooLong;
}

/// Appends the fields from the version needed to the bytes, which both headers have alike.
void append_common(std::vector<std::byte>& bytes, const ArchiveEntry& entry) {
  append_little(bytes, is_far(entry) ? kZip64Version : kPlainVersion);
  append_little<std::uint16_t>(bytes, 0);  // flags
  append_little<std::uint16_t>(bytes, 0);  // method: stored
  append_little<std::uint16_t>(bytes, 0);  // time
  append_little(bytes, kFirstDay);
  append_little(bytes, entry.crc);
  append_little(bytes, entry.bytes);
  append_little(bytes, entry.bytes);
  append_little(bytes, static_cast<std::uint16_t>(entry.name.size()));
}

void append_text(std::vector<std::byte>& bytes, std::string_view text) {
  for (const char c : text)
    bytes.push_back(static_cast<std::byte>(c));
}

std::string_view text_at(std::span<const std::byte> bytes, std::size_t offset, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes.data()) + offset, size};
}

bool begins_with(std::span<const std::byte> bytes, std::uint32_t mark) {
  return bytes.size() >= 4 && load_little<std::uint32_t>(bytes.data()) == mark;
}

[[noreturn]] void refuse_archive(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::corrupt, fmt::format("{}: {}", name, what));
}

void append_zip64_end(std::vector<std::byte>& bytes, const ArchiveEnd& end) {
  append_little(bytes, kZip64EndMark);
  append_little<std::uint64_t>(bytes, kZip64EndBytes - 12);
  append_little(bytes, kZip64Version);
  append_little(bytes, kZip64Version);
  append_little<std::uint64_t>(bytes, 0);  // this disk, and that of the directory
  append_little(bytes, end.entries);
  append_little(bytes, end.entries);
  append_little(bytes, end.directory_bytes);
  append_little(bytes, end.directory);
  append_little(bytes, kZip64LocatorMark);
  append_little<std::uint32_t>(bytes, 0);
  append_little(bytes, end.directory + end.directory_bytes);
  append_little<std::uint32_t>(bytes, 1);  // disks
}

bool needs_zip64(const ArchiveEnd& end) {
  return end.entries >= kTooMany || end.directory >= kTooLong || end.directory_bytes >= kTooLong;
}

/// Returns what the records at the end of `last` say; it must be long enough for them.
ArchiveEnd load_end(std::span<const std::byte> last) {
  const std::byte* at = last.data() + last.size() - kEndBytes;
  const ArchiveEnd end{load_little<std::uint16_t>(at + 10), load_little<std::uint32_t>(at + 16),
                       load_little<std::uint32_t>(at + 12)};
  if (!needs_zip64(end) || last.size() < kLongestArchiveEnd)
    return end;
  at = last.data() + last.size() - kLongestArchiveEnd;
  return {load_little<std::uint64_t>(at + 32), load_little<std::uint64_t>(at + 48),
          load_little<std::uint64_t>(at + 40)};
}

std::pair<std::uint64_t, std::uint64_t> order_of(const IndexPlace& place) {
  return {load_little<std::uint64_t>(place.data()), load_little<std::uint64_t>(place.data() + 8)};
}

}  // namespace

std::uint64_t ArchiveEntry::content() const {
  return offset + kLocalHeaderBytes + name.size();
}

bool is_archive_name(std::string_view name) {
  if (name.size() > kLongestArchiveName)
    return false;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    const std::string_view part = name.substr(begin, end - begin);
    if (part.empty() || part == "." || part == "..")
      return false;
    begin = end + 1;
  }
  return std::all_of(name.begin(), name.end(),
                     [](char c) { return c > ' ' && c <= '~' && c != '\\'; });
}

void append_local_header(std::vector<std::byte>& bytes, const ArchiveEntry& entry) {
  append_little(bytes, kLocalMark);
  append_common(bytes, entry);
  append_little<std::uint16_t>(bytes, 0);  // extra
  append_text(bytes, entry.name);
}

void append_central_header(std::vector<std::byte>& bytes, const ArchiveEntry& entry) {
  append_little(bytes, kCentralMark);
  append_little(bytes, kZip64Version);  // made by
  append_common(bytes, entry);
  append_little<std::uint16_t>(bytes, is_far(entry) ? 12 : 0);
  append_little<std::uint16_t>(bytes, 0);  // comment
  append_little<std::uint16_t>(bytes, 0);  // disk
  append_little<std::uint16_t>(bytes, 0);  // attributes
  append_little<std::uint32_t>(bytes, 0);
  append_little(bytes, static_cast<std::uint32_t>(std::min(entry.offset, kTooLong)));
  append_text(bytes, entry.name);
  if (!is_far(entry))
    return;
  append_little(bytes, kZip64Extra);
  append_little<std::uint16_t>(bytes, sizeof(std::uint64_t));
  append_little(bytes, entry.offset);
}

ArchiveEntry parse_local_header(std::span<const std::byte> bytes, std::uint64_t offset,
                                const std::string& name) {
  if (bytes.size() < kLocalHeaderBytes || !begins_with(bytes, kLocalMark))
    refuse_archive(name, fmt::format("expected a file's header at byte {}", offset));
  const std::size_t name_bytes = load_little<std::uint16_t>(bytes.data() + 26);
  if (bytes.size() - kLocalHeaderBytes < name_bytes)
    refuse_archive(name,
                   fmt::format("the file's name at byte {} is cut", offset + kLocalHeaderBytes));
  return {std::string(text_at(bytes, kLocalHeaderBytes, name_bytes)), offset,
          load_little<std::uint32_t>(bytes.data() + 18),
          load_little<std::uint32_t>(bytes.data() + 14)};
}

CentralHeader parse_central_header(std::span<const std::byte> bytes, std::uint64_t offset,
                                   const std::string& name) {
  if (bytes.size() < kCentralHeaderBytes || !begins_with(bytes, kCentralMark))
    refuse_archive(name, "the list of its files is broken or shorter than said");
  const std::byte* at = bytes.data();
  const std::size_t name_bytes = load_little<std::uint16_t>(at + 28);
  if (bytes.size() - kCentralHeaderBytes < name_bytes)
    refuse_archive(name, "the list of its files ends within a name");
  const ArchiveEntry entry{std::string(text_at(bytes, kCentralHeaderBytes, name_bytes)), offset,
                           load_little<std::uint32_t>(at + 24),
                           load_little<std::uint32_t>(at + 16)};
  const std::string shown = plain_text(entry.name, kLongestArchiveName);
  if (!is_archive_name(entry.name))
    refuse_archive(name, fmt::format("\"{}\" is no name of a file in a hierarchy", shown));
  std::vector<std::byte> expected;
  append_central_header(expected, entry);
  if (bytes.size() < expected.size() || !std::equal(expected.begin(), expected.end(), at)) {
    refuse_archive(name,
                   fmt::format("{}: its place in the list of files is not that of a stored file at "
                               "byte {}",
                               shown, offset));
  }
  return {entry, expected.size()};
}

std::vector<std::byte> encode_archive_end(const ArchiveEnd& end) {
  std::vector<std::byte> bytes;
  if (needs_zip64(end))
    append_zip64_end(bytes, end);
  append_little(bytes, kEndMark);
  append_little<std::uint32_t>(bytes, 0);  // this disk, and that of the directory
  const auto entries = static_cast<std::uint16_t>(std::min(end.entries, kTooMany));
  append_little(bytes, entries);
  append_little(bytes, entries);
  append_little(bytes, static_cast<std::uint32_t>(std::min(end.directory_bytes, kTooLong)));
  append_little(bytes, static_cast<std::uint32_t>(std::min(end.directory, kTooLong)));
  append_little<std::uint16_t>(bytes, 0);  // comment
  return bytes;
}

ArchiveEnd parse_archive_end(std::span<const std::byte> last, std::uint64_t file_bytes,
                             const std::string& name) {
  const char* const cut = "does not end as an archive does: the file is cut or damaged";
  if (last.size() < kEndBytes || !begins_with(last.last(kEndBytes), kEndMark))
    refuse_archive(name, cut);
  const ArchiveEnd end = load_end(last);
  const std::vector<std::byte> expected = encode_archive_end(end);
  if (expected.size() > last.size() ||
      !std::equal(expected.begin(), expected.end(), last.last(expected.size()).begin()))
    refuse_archive(name, cut);
  const std::uint64_t before = file_bytes - expected.size();
  if (end.directory_bytes > before || end.directory != before - end.directory_bytes) {
    refuse_archive(
        name, fmt::format("has {} bytes, and the list of its files should be {} bytes from byte "
                          "{} on: the file is cut or damaged",
                          file_bytes, end.directory_bytes, end.directory));
  }
  return end;
}

bool looks_like_archive(std::span<const std::byte> first, std::span<const std::byte> last) {
  return begins_with(first, kLocalMark) ||
         (last.size() >= kEndBytes && begins_with(last.last(kEndBytes), kEndMark));
}

IndexPlace index_place(std::string_view name, std::uint64_t offset) {
  IndexPlace place{};
  const auto digest = md5(name);
  std::copy(digest.begin(), digest.end(), place.begin());
  store_little(offset, place.data() + digest.size());
  return place;
}

bool comes_before(const IndexPlace& a, const IndexPlace& b) {
  return order_of(a) < order_of(b);
}

}  // namespace meshhier::storage
