#include "storage/io/zip_content.h"

#include "base/error.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

namespace meshhier::storage {
namespace {

constexpr std::size_t kUnpackedBlock = std::size_t{1} << 16;
/// Files up to this size are kept when they are read backwards.
constexpr std::uint64_t kMostKept = std::uint64_t{16} << 20;
/// Levels up to 19 take windows of up to 8 MiB.
constexpr int kWindowLog = 23;

class ZippedFile : public ReadOnlyFile {
 public:
  ZippedFile(std::filesystem::path path, std::shared_ptr<const File> archive, const ZipRange& range)
      : ReadOnlyFile(std::move(path)), archive_(std::move(archive)), range_(range) {}
  std::uint64_t size() const override { return range_.bytes; }
  FileVersion version() const override {
    FileVersion version = archive_->version();
    version.bytes = range_.bytes;
    return version;
  }

 protected:
  const File& archive() const { return *archive_; }
  const ZipRange& range() const { return range_; }

 private:
  std::shared_ptr<const File> archive_;
  ZipRange range_;
};

class StoredFile final : public ZippedFile {
 public:
  using ZippedFile::ZippedFile;

 private:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    const std::uint64_t left = size() - std::min(offset, size());
    const std::size_t count = std::min<std::uint64_t>(bytes.size(), left);
    return archive().read_at(range().begin + offset, bytes.first(count));
  }
};

/// The packed bytes, in order.
class PackedBytes {
 public:
  PackedBytes(const File& archive, const ZipRange& range)
      : archive_(archive), at_(range.begin), left_(range.packed), block_(kUnpackedBlock) {}

  /// Returns the next ones; none at the end.
  std::span<const std::byte> next() {
    const auto block = std::span(block_).first(std::min<std::uint64_t>(block_.size(), left_));
    archive_.read_exact(at_, block);
    at_ += block.size();
    left_ -= block.size();
    return block;
  }

 private:
  const File& archive_;
  std::uint64_t at_, left_;
  std::vector<std::byte> block_;
};

/// One way from the beginning to the end of what is packed.
class Unpacking {
 public:
  Unpacking() = default;
  Unpacking(const Unpacking&) = delete;
  Unpacking& operator=(const Unpacking&) = delete;
  virtual ~Unpacking() = default;
  /// Fills `to`, or less where the content ends or is damaged; returns how many bytes.
  virtual std::size_t next(std::span<std::byte> to) = 0;
};

class Inflating final : public Unpacking {
 public:
  explicit Inflating(PackedBytes packed) : packed_(std::move(packed)) {
    constexpr int kRawWindow = -15;
    if (inflateInit2(&stream_, kRawWindow) != Z_OK)
      throw Error(ErrorCode::internal, "zlib cannot begin");
  }
  ~Inflating() override { inflateEnd(&stream_); }

  std::size_t next(std::span<std::byte> to) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to.data());
    stream_.avail_out = static_cast<uInt>(to.size());
    for (int result = Z_OK; result == Z_OK && stream_.avail_out > 0;) {
      if (stream_.avail_in == 0)
        take(packed_.next());
      result = inflate(&stream_, Z_NO_FLUSH);
    }
    return to.size() - stream_.avail_out;
  }

 private:
  void take(std::span<const std::byte> packed) {
    stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data()));
    stream_.avail_in = static_cast<uInt>(packed.size());
  }

  PackedBytes packed_;
  z_stream stream_{};
};

class ZstandardUnpacking final : public Unpacking {
 public:
  explicit ZstandardUnpacking(PackedBytes packed)
      : packed_(std::move(packed)), stream_(ZSTD_createDCtx(), ZSTD_freeDCtx) {
    if (!stream_ ||
        ZSTD_isError(ZSTD_DCtx_setParameter(stream_.get(), ZSTD_d_windowLogMax, kWindowLog)) != 0)
      throw Error(ErrorCode::internal, "zstd cannot begin");
  }

  std::size_t next(std::span<std::byte> to) override {
    ZSTD_outBuffer out{to.data(), to.size(), 0};
    while (out.pos < out.size) {
      if (in_.pos == in_.size && !take(packed_.next()))
        break;
      if (ZSTD_isError(ZSTD_decompressStream(stream_.get(), &out, &in_)) != 0)
        break;
    }
    return out.pos;
  }

 private:
  bool take(std::span<const std::byte> packed) {
    in_ = {packed.data(), packed.size(), 0};
    return !packed.empty();
  }

  PackedBytes packed_;
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> stream_;
  ZSTD_inBuffer in_{};
};

class PackedFile final : public ZippedFile {
 public:
  using ZippedFile::ZippedFile;

 private:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= size() || bytes.empty())
      return 0;
    const std::lock_guard lock(mutex_);
    go_to(offset);
    const std::size_t skipped = offset - block_at_;
    const std::size_t count = std::min(bytes.size(), block_.size() - skipped);
    std::memcpy(bytes.data(), block_.data() + skipped, count);
    return count;
  }

  /// Unpacks the block that has a byte of the file.
  void go_to(std::uint64_t offset) const {
    if (!unpacking_ || offset < block_at_)
      begin();
    while (offset >= block_at_ + block_.size())
      unpack_block();
  }

  void begin() const {
    if (unpacking_ && size() <= kMostKept)
      block_bytes_ = size();
    PackedBytes packed(archive(), range());
    if (range().method == ZipMethod::deflated)
      unpacking_ = std::make_unique<Inflating>(std::move(packed));
    else
      unpacking_ = std::make_unique<ZstandardUnpacking>(std::move(packed));
    block_.clear();
    block_at_ = 0;
    crc_ = 0;
  }

  void unpack_block() const {
    block_at_ += block_.size();
    const std::uint64_t left = size() - block_at_;
    block_.resize(std::min<std::uint64_t>(block_bytes_, left));
    if (unpacking_->next(block_) < block_.size())
      fail();
    crc_ = static_cast<std::uint32_t>(
        crc32_z(crc_, reinterpret_cast<const Bytef*>(block_.data()), block_.size()));
    std::byte behind{};
    if (block_.size() == left && (unpacking_->next({&behind, 1}) != 0 || crc_ != range().crc))
      fail();
  }

  [[noreturn]] void fail() const {
    unpacking_.reset();
    throw Error(ErrorCode::input,
                fmt::format("{}: is damaged: what is packed is not what the archive's directory "
                            "says, or wants a window of more than {} MiB",
                            path().string(), (std::uint64_t{1} << kWindowLog) >> 20));
  }

  mutable std::mutex mutex_;
  mutable std::unique_ptr<Unpacking> unpacking_;  ///< has unpacked up to the end of the block
  mutable std::uint64_t block_bytes_ = kUnpackedBlock;
  mutable std::vector<std::byte> block_;
  mutable std::uint64_t block_at_ = 0;
  mutable std::uint32_t crc_ = 0;  ///< of all up to the end of the block
};

}  // namespace

std::unique_ptr<File> open_zip_content(std::filesystem::path path,
                                       std::shared_ptr<const File> archive, const ZipRange& range) {
  if (range.method == ZipMethod::stored)
    return std::make_unique<StoredFile>(std::move(path), std::move(archive), range);
  return std::make_unique<PackedFile>(std::move(path), std::move(archive), range);
}

}  // namespace meshhier::storage
