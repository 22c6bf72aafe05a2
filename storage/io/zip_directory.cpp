#include "storage/io/zip_directory.h"

#include "base/error.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

namespace meshhier::storage {
namespace {

constexpr std::string_view kEndMark{"PK\5\6"}, kLocatorMark{"PK\6\7"}, kEnd64Mark{"PK\6\6"},
    kCentralMark{"PK\1\2"}, kLocalMark{"PK\3\4"};
constexpr std::size_t kEndBytes = 22, kLocatorBytes = 20, kEnd64Bytes = 56, kCentralBytes = 46,
                      kLocalBytes = 30, kLongestComment = 65535;
constexpr std::uint32_t kInExtra32 = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint16_t kInExtra16 = std::numeric_limits<std::uint16_t>::max();
constexpr std::uint16_t kZip64Extra = 1, kEncrypted = 1;
enum Method : std::uint16_t { kStored = 0, kDeflated = 8, kZstandard = 93 };
/// Files up to this size are kept for the next one who opens them.
constexpr std::size_t kMostKept = std::size_t{8} << 20;

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

ZipEnd read_end64(const File& file, std::uint64_t end) {
  if (end < kLocatorBytes)
    fail(file, "has no end of its directory");
  const auto locator = read_part(file, end - kLocatorBytes, kLocatorBytes);
  if (!text_of(locator).starts_with(kLocatorMark))
    fail(file, "has no end of its directory");
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
    return is_zip64 ? read_end64(file, size - end.size()) : found;
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

/// Reads the header at the beginning of `bytes` and removes it from them.
ZipEntry take_entry(std::span<const std::byte>& bytes, const File& file) {
  if (bytes.size() < kCentralBytes || !text_of(bytes).starts_with(kCentralMark))
    fail(file, "has a broken directory");
  const std::size_t name = number<std::uint16_t>(bytes, 28);
  const std::size_t extra = number<std::uint16_t>(bytes, 30);
  const std::size_t all = kCentralBytes + name + extra + number<std::uint16_t>(bytes, 32);
  if (all > bytes.size())
    fail(file, "has a broken directory");
  ZipEntry entry{.name = std::string(text_of(bytes.subspan(kCentralBytes, name))),
                 .header = number<std::uint32_t>(bytes, 42),
                 .packed = number<std::uint32_t>(bytes, 20),
                 .bytes = number<std::uint32_t>(bytes, 24),
                 .crc = number<std::uint32_t>(bytes, 16),
                 .flags = number<std::uint16_t>(bytes, 8),
                 .method = number<std::uint16_t>(bytes, 10)};
  take_extra(bytes.subspan(kCentralBytes + name, extra), entry);
  bytes = bytes.subspan(all);
  return entry;
}

bool inflate_whole(std::span<const std::byte> packed, std::span<std::byte> to) {
  z_stream stream{};
  constexpr int kRawWindow = -15;
  if (inflateInit2(&stream, kRawWindow) != Z_OK)
    throw Error(ErrorCode::internal, "zlib cannot begin");
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(to.data());
  stream.avail_out = static_cast<uInt>(to.size());
  const int result = inflate(&stream, Z_FINISH);
  const bool is_whole = result == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  return is_whole;
}

bool unpack(std::uint16_t method, std::span<const std::byte> packed, std::span<std::byte> to) {
  if (method == kDeflated)
    return inflate_whole(packed, to);
  return ZSTD_decompress(to.data(), to.size(), packed.data(), packed.size()) == to.size();
}

/// A file that cannot be written.
class ZippedFile : public File {
 public:
  ZippedFile(std::filesystem::path path, std::shared_ptr<const File> archive, std::uint64_t bytes)
      : File(std::move(path)), archive_(std::move(archive)), bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_; }
  FileVersion version() const override {
    FileVersion version = archive_->version();
    version.bytes = bytes_;
    return version;
  }
  void sync() override {}
  using File::sync;

 protected:
  /// Reads a range that lies within the file.
  virtual void read_within(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    const std::uint64_t left = bytes_ - std::min(offset, bytes_);
    const std::size_t count = std::min<std::uint64_t>(bytes.size(), left);
    if (count > 0)
      read_within(offset, bytes.first(count));
    return count;
  }
  std::size_t write_some(std::uint64_t, std::span<const std::byte>) override {
    throw Error(ErrorCode::io,
                fmt::format("cannot write {}: it lies in an archive", path().string()));
  }
  const File& archive() const { return *archive_; }

 private:
  std::shared_ptr<const File> archive_;
  std::uint64_t bytes_;
};

class StoredFile final : public ZippedFile {
 public:
  StoredFile(std::filesystem::path path, std::shared_ptr<const File> archive, std::uint64_t begin,
             std::uint64_t bytes)
      : ZippedFile(std::move(path), std::move(archive), bytes), begin_(begin) {}

 private:
  void read_within(std::uint64_t offset, std::span<std::byte> bytes) const override {
    archive().read_exact(begin_ + offset, bytes);
  }
  std::uint64_t begin_;
};

class UnpackedFile final : public ZippedFile {
 public:
  UnpackedFile(std::filesystem::path path, std::shared_ptr<const File> archive,
               std::shared_ptr<const std::vector<std::byte>> content)
      : ZippedFile(std::move(path), std::move(archive), content->size()),
        content_(std::move(content)) {}

 private:
  void read_within(std::uint64_t offset, std::span<std::byte> bytes) const override {
    std::memcpy(bytes.data(), content_->data() + offset, bytes.size());
  }
  std::shared_ptr<const std::vector<std::byte>> content_;
};

}  // namespace

ZipDirectory::ZipDirectory(std::shared_ptr<const File> archive) : file_(std::move(archive)) {
  const ZipEnd end = read_end(*file_);
  if (end.bytes > kMostDirectory)
    fail(*file_, fmt::format("has a directory of {} bytes, up to {} are read; unpack it", end.bytes,
                             kMostDirectory));
  const std::vector<std::byte> directory = read_part(*file_, end.offset, end.bytes);
  for (std::span<const std::byte> left = directory; !left.empty();) {
    entries_.push_back(take_entry(left, *file_));
    if (entries_.back().name.ends_with('/'))
      entries_.pop_back();
  }
  std::ranges::stable_sort(entries_, {}, &ZipEntry::name);
}

const ZipEntry* ZipDirectory::find(std::string_view name) const {
  const auto found = std::ranges::lower_bound(entries_, name, {}, &ZipEntry::name);
  return found != entries_.end() && found->name == name ? &*found : nullptr;
}

std::span<const ZipEntry> ZipDirectory::starting_with(std::string_view start) const {
  const auto head = [&](const ZipEntry& entry) {
    return std::string_view(entry.name).substr(0, start.size());
  };
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
  if (entry.method == kStored) {
    if (entry.packed != entry.bytes)
      refuse("has two sizes in the archive's directory");
    return std::make_unique<StoredFile>(path, file_, begin, entry.bytes);
  }
  if (entry.method != kDeflated && entry.method != kZstandard)
    refuse(fmt::format("is packed by method {}; Deflate and Zstandard are read: unpack the archive",
                       entry.method));
  if (std::max(entry.bytes, entry.packed) > kMostPacked)
    refuse(fmt::format("is packed from {} bytes, up to {} are read; unpack the archive",
                       entry.bytes, kMostPacked));
  constexpr std::uint64_t kMostDeflated = 1032;  // bytes that Deflate makes of one
  if (entry.method == kDeflated && entry.bytes / kMostDeflated > entry.packed + 1)
    refuse("is damaged: Deflate cannot have packed it so small");
  const Bytes bytes = unpacked(entry, begin);
  if (bytes == nullptr)
    refuse("is damaged: what is packed is not what the archive's directory says");
  return std::make_unique<UnpackedFile>(path, file_, bytes);
}

ZipDirectory::Bytes ZipDirectory::unpacked(const ZipEntry& entry, std::uint64_t begin) const {
  {
    const std::lock_guard lock(mutex_);
    if (last_ == &entry)
      return last_bytes_;
  }
  const auto packed = read_part(*file_, begin, entry.packed);
  auto content = std::make_shared<std::vector<std::byte>>(entry.bytes);
  if (!unpack(entry.method, packed, *content))
    return nullptr;
  const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(content->data()), content->size());
  if (sum != entry.crc)
    return nullptr;
  if (content->size() <= kMostKept) {
    const std::lock_guard lock(mutex_);
    last_ = &entry;
    last_bytes_ = content;
  }
  return content;
}

}  // namespace meshhier::storage
