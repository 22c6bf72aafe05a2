#include "storage/io/zip_directory.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/io/little_endian.h"
#include "storage/io/zip_content.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

constexpr std::string_view kEndMark{"PK\5\6"}, kLocatorMark{"PK\6\7"}, kEnd64Mark{"PK\6\6"},
    kCentralMark{"PK\1\2"}, kLocalMark{"PK\3\4"};
constexpr std::size_t kEndBytes = 22, kLocatorBytes = 20, kEnd64Bytes = 56, kCentralBytes = 46,
                      kLocalBytes = 30, kLongestComment = 65535, kLongestName = 255;
constexpr std::uint32_t kInExtra32 = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint16_t kInExtra16 = std::numeric_limits<std::uint16_t>::max();
constexpr std::uint16_t kZip64Extra = 1, kEncrypted = 1;
/// The directory is read in blocks; the longest header of a file fits.
constexpr std::size_t kDirectoryBlock = std::size_t{1} << 20;

template <class T>
T number(std::span<const std::byte> bytes, std::size_t at) {
  return load_little<T>(bytes.data() + at);
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[noreturn]] void fail(const File& archive, const std::string& message) {
  throw Error(ErrorCode::input, archive.path().string() + ": the archive " + message);
}

/// The place of the directory in the archive.
struct ZipEnd {
  std::uint64_t files = 0, bytes = 0, offset = 0;
};

std::vector<std::byte> read_part(const File& file, std::uint64_t offset, std::uint64_t bytes) {
  const std::uint64_t size = file.size();
  if (offset > size || bytes > size - offset)
    fail(file, fmt::format("ends before byte {} (truncated?)", offset));
  std::vector<std::byte> part(bytes);
  file.read_exact(offset, part);
  return part;
}

/// `found`: what the short end says, which may end at numbers that are all ones by chance.
ZipEnd read_end64(const File& file, std::uint64_t end, const ZipEnd& found) {
  if (end < kLocatorBytes)
    return found;
  const auto locator = read_part(file, end - kLocatorBytes, kLocatorBytes);
  if (!text_of(locator).starts_with(kLocatorMark))
    return found;
  const auto end64 = read_part(file, number<std::uint64_t>(locator, 8), kEnd64Bytes);
  if (!text_of(end64).starts_with(kEnd64Mark))
    fail(file, "has no end of its directory");
  return {number<std::uint64_t>(end64, 32), number<std::uint64_t>(end64, 40),
          number<std::uint64_t>(end64, 48)};
}

ZipEnd read_end(const File& file) {
  const std::uint64_t size = file.size();
  const std::uint64_t count = std::min<std::uint64_t>(size, kEndBytes + kLongestComment);
  const auto last = read_part(file, size - count, count);
  for (std::size_t left = count; left >= kEndBytes; --left) {
    const auto end = std::span<const std::byte>(last).subspan(left - kEndBytes);
    if (!text_of(end).starts_with(kEndMark) ||
        kEndBytes + number<std::uint16_t>(end, 20) != end.size())
      continue;
    const ZipEnd found{number<std::uint16_t>(end, 10), number<std::uint32_t>(end, 12),
                       number<std::uint32_t>(end, 16)};
    const bool is_zip64 =
        found.files == kInExtra16 || found.bytes == kInExtra32 || found.offset == kInExtra32;
    return is_zip64 ? read_end64(file, size - end.size(), found) : found;
  }
  fail(file, "has no end (truncated?)");
}

/// Replaces numbers that are all ones by those in the extra.
void take_extra(std::span<const std::byte> extra, ZipEntry& entry) {
  const auto has = [&](std::size_t at, std::size_t bytes) { return at + bytes <= extra.size(); };
  for (std::size_t at = 0; has(at, 4);) {
    const auto kind = number<std::uint16_t>(extra, at);
    const std::size_t next = at + 4 + number<std::uint16_t>(extra, at + 2);
    at += 4;
    for (std::uint64_t* value : {&entry.bytes, &entry.packed, &entry.header}) {
      if (kind != kZip64Extra || *value != kInExtra32 || at + 8 > next || !has(at, 8))
        continue;
      *value = number<std::uint64_t>(extra, at);
      at += 8;
    }
    at = next;
  }
}

/// A header of the directory.
struct CentralHeader {
  std::string_view name;
  std::span<const std::byte> extra;
  std::size_t bytes = 0;  ///< with all that belongs to it
};

/// Returns nothing if `bytes` end before the header does.
std::optional<CentralHeader> header_of(std::span<const std::byte> bytes, const File& file) {
  if (bytes.size() < kCentralBytes)
    return std::nullopt;
  if (!text_of(bytes).starts_with(kCentralMark))
    fail(file, "has a broken directory");
  const std::size_t name = number<std::uint16_t>(bytes, 28);
  const std::size_t extra = number<std::uint16_t>(bytes, 30);
  const std::size_t all = kCentralBytes + name + extra + number<std::uint16_t>(bytes, 32);
  if (all > bytes.size())
    return std::nullopt;
  return CentralHeader{text_of(bytes.subspan(kCentralBytes, name)),
                       bytes.subspan(kCentralBytes + name, extra), all};
}

ZipEntry entry_of(std::span<const std::byte> bytes, const CentralHeader& header) {
  ZipEntry entry{.header = number<std::uint32_t>(bytes, 42),
                 .packed = number<std::uint32_t>(bytes, 20),
                 .bytes = number<std::uint32_t>(bytes, 24),
                 .crc = number<std::uint32_t>(bytes, 16),
                 .flags = number<std::uint16_t>(bytes, 8),
                 .method = number<std::uint16_t>(bytes, 10)};
  take_extra(header.extra, entry);
  return entry;
}

/// Returns "a/b" for "./a/b", "/a/b" and, as programs of Windows write it, "a\b".
std::string plain_name(std::string_view name) {
  std::string plain(name);
  std::ranges::replace(plain, '\\', '/');
  while (plain.starts_with("./") || plain.starts_with('/'))
    plain.erase(0, plain.find('/') + 1);
  return plain;
}

}  // namespace

ZipDirectory::ZipDirectory(std::shared_ptr<const File> archive) : file_(std::move(archive)) {
  const ZipEnd end = read_end(*file_);
  if (end.bytes > kMostDirectory)
    fail(*file_, fmt::format("has a directory of {} bytes, up to {} are read; unpack it", end.bytes,
                             kMostDirectory));
  const std::uint64_t size = file_->size();
  if (end.offset > size || end.bytes > size - end.offset)
    fail(*file_, fmt::format("ends before byte {} (truncated?)", end.offset));
  entries_.reserve(std::min(end.files, end.bytes / kCentralBytes));
  std::vector<std::byte> block;
  for (std::uint64_t at = end.offset, left = end.bytes; left > 0;) {
    block.resize(std::min<std::uint64_t>(kDirectoryBlock, left));
    file_->read_exact(at, block);
    const std::size_t taken = take_entries(block);
    if (taken == 0)
      fail(*file_, "has a broken directory");
    at += taken;
    left -= taken;
  }
  std::ranges::stable_sort(entries_, {}, [this](const ZipEntry& entry) { return name_of(entry); });
  require_one_of_each();
}

/// Takes the headers that lie in a block as a whole; returns their bytes.
std::size_t ZipDirectory::take_entries(std::span<const std::byte> block) {
  std::size_t at = 0;
  while (const auto header = header_of(block.subspan(at), *file_)) {
    const std::string name = plain_name(header->name);
    if (!name.ends_with('/')) {
      entries_.push_back(storage::entry_of(block.subspan(at), *header));
      entries_.back().name_at = static_cast<std::uint32_t>(names_.size());
      entries_.back().name_bytes = static_cast<std::uint16_t>(name.size());
      names_ += name;
    }
    at += header->bytes;
  }
  return at;
}

/// Of two files of one name some programs take the first, some the last one. The same file twice
/// is one.
void ZipDirectory::require_one_of_each() {
  const auto is_same = [this](const ZipEntry& a, const ZipEntry& b) {
    if (name_of(a) != name_of(b))
      return false;
    if (a.bytes != b.bytes || a.crc != b.crc)
      fail(*file_, fmt::format("has two different files {}; unpack it, and build the one that is "
                               "meant",
                               plain_text(std::string(name_of(a)), kLongestName)));
    return true;
  };
  const auto same = std::ranges::unique(entries_, is_same);
  entries_.erase(same.begin(), same.end());
}

const ZipEntry* ZipDirectory::find(std::string_view name) const {
  const auto name_of_entry = [this](const ZipEntry& entry) { return name_of(entry); };
  const auto found = std::ranges::lower_bound(entries_, name, {}, name_of_entry);
  return found != entries_.end() && name_of(*found) == name ? &*found : nullptr;
}

std::span<const ZipEntry> ZipDirectory::starting_with(std::string_view start) const {
  const auto head = [&](const ZipEntry& entry) { return name_of(entry).substr(0, start.size()); };
  return {std::ranges::lower_bound(entries_, start, {}, head),
          std::ranges::upper_bound(entries_, start, {}, head)};
}

std::unique_ptr<File> ZipDirectory::open(const ZipEntry& entry,
                                         const std::filesystem::path& path) const {
  const auto refuse = [&](const std::string& message) {
    throw Error(ErrorCode::input, path.string() + ": " + message);
  };
  if ((entry.flags & kEncrypted) != 0)
    refuse("is encrypted; unpack the archive");
  const auto header = read_part(*file_, entry.header, kLocalBytes);
  if (!text_of(header).starts_with(kLocalMark))
    refuse("is not where the archive's directory says");
  const std::uint64_t begin = entry.header + kLocalBytes + number<std::uint16_t>(header, 26) +
                              number<std::uint16_t>(header, 28);
  const std::uint64_t size = file_->size();
  if (begin > size || entry.packed > size - begin)
    refuse("reaches beyond the end of the archive (truncated?)");
  const ZipMethod method{entry.method};
  if (method == ZipMethod::stored && entry.packed != entry.bytes)
    refuse("has two sizes in the archive's directory");
  if (method != ZipMethod::stored && method != ZipMethod::deflated &&
      method != ZipMethod::zstandard)
    refuse(fmt::format("is packed by method {}; Deflate and Zstandard are read: unpack the archive",
                       entry.method));
  if (method != ZipMethod::stored && std::max(entry.bytes, entry.packed) > kMostPacked)
    refuse(fmt::format("is packed from {} bytes, up to {} are read; unpack the archive",
                       entry.bytes, kMostPacked));
  constexpr std::uint64_t kMostDeflated = 1032;  // bytes that Deflate makes of one
  if (method == ZipMethod::deflated && entry.bytes / kMostDeflated > entry.packed + 1)
    refuse("is damaged: Deflate cannot have packed it so small");
  return open_zip_content(path, file_, {method, begin, entry.packed, entry.bytes, entry.crc});
}

}  // namespace meshhier::storage
