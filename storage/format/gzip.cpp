#include "storage/format/gzip.h"

#include "base/error.h"
#include "storage/format/glb.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <zlib.h>

namespace meshhier::storage {
namespace {

constexpr int kGzipWindow = 15 + 16;  // the largest window, in a gzip member
constexpr int kMemoryLevel = 9;       // 256 kiB: 0.3 % smaller than with the usual 8
constexpr int kUnknownSystem = 255;

/// One byte of deflate stands for so many bytes at most (zlib's technical description).
constexpr std::uint64_t kMostInflation = 1032;

constexpr std::size_t kGlbHeadBytes = 12;

const Bytef* input_of(std::span<const std::byte> bytes) {
  return reinterpret_cast<const Bytef*>(bytes.data());
}

/// Reads one gzip member piece by piece.
class Inflater {
 public:
  Inflater(std::span<const std::byte> bytes, const std::string& name) : name_(name) {
    stream_.next_in = const_cast<Bytef*>(input_of(bytes));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    if (inflateInit2(&stream_, kGzipWindow) != Z_OK)
      throw Error(ErrorCode::internal, "zlib cannot begin");
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

  /// Fills `to`; throws if there is less.
  void read(std::span<std::byte> to) {
    inflate_into(to);
    if (stream_.avail_out > 0) {
      fail(fmt::format("the gzip stream ends after {} bytes, expected {}", stream_.total_out,
                       stream_.total_out + stream_.avail_out));
    }
  }

  /// Fills as much of `to` as there is; returns how much.
  std::size_t read_up_to(std::span<std::byte> to) {
    inflate_into(to);
    return to.size() - stream_.avail_out;
  }

  /// Checks the member's own checksum, and that nothing is left.
  void finish() {
    std::array<std::byte, 1> more;
    inflate_into(more);
    if (stream_.avail_out == 0)
      fail(fmt::format("the gzip stream goes on after the {} bytes expected",
                       stream_.total_out - 1));
    if (!ended_)
      fail("the gzip stream is cut");
    if (stream_.avail_in > 0)
      fail(fmt::format("{} bytes after the gzip stream", stream_.avail_in));
  }

 private:
  void inflate_into(std::span<std::byte> to) {
    stream_.next_out = reinterpret_cast<Bytef*>(to.data());
    stream_.avail_out = static_cast<uInt>(to.size());
    if (ended_)
      return;
    const int result = inflate(&stream_, Z_SYNC_FLUSH);
    if (result == Z_MEM_ERROR)
      throw Error(ErrorCode::internal, "zlib is out of memory");
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) {
      fail(fmt::format("is no gzip stream: {} at byte {}",
                       stream_.msg != nullptr ? stream_.msg : "damaged", stream_.total_in));
    }
    ended_ = result == Z_STREAM_END;
  }

  z_stream stream_{};
  bool ended_ = false;
  const std::string& name_;
};

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(::crc32_z(before, input_of(bytes), bytes.size()));
}

std::vector<std::byte> gzip(std::span<const std::byte> bytes, Repetitions repetitions) {
  z_stream stream{};
  gz_header header{};
  header.os = kUnknownSystem;
  const int level = Z_BEST_COMPRESSION;
  const int strategy = repetitions == Repetitions::all ? Z_DEFAULT_STRATEGY : Z_RLE;
  if (bytes.size() > UINT32_MAX ||
      deflateInit2(&stream, level, Z_DEFLATED, kGzipWindow, kMemoryLevel, strategy) != Z_OK)
    throw Error(ErrorCode::internal, "zlib cannot begin");
  deflateSetHeader(&stream, &header);
  std::vector<std::byte> packed(deflateBound(&stream, static_cast<uLong>(bytes.size())));
  stream.next_in = const_cast<Bytef*>(input_of(bytes));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END)
    throw Error(ErrorCode::internal, "zlib cannot end");
  return packed;
}

std::vector<std::byte> gunzip(std::span<const std::byte> bytes, std::size_t most_bytes,
                              const std::string& name) {
  if (bytes.size() > UINT32_MAX)
    throw Error(ErrorCode::corrupt, name + ": is too large for a gzip member");
  Inflater inflater(bytes, name);
  std::vector<std::byte> plain(std::min<std::uint64_t>(most_bytes, kMostInflation * bytes.size()));
  plain.resize(inflater.read_up_to(plain));
  inflater.finish();
  return plain;
}

std::vector<std::byte> gunzip_glb(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.size() > UINT32_MAX)
    throw Error(ErrorCode::corrupt, name + ": is too large for a tile");
  Inflater inflater(bytes, name);
  std::array<std::byte, kGlbHeadBytes> head;
  inflater.read(head);
  const std::uint64_t size = load_little<std::uint32_t>(head.data() + 8);
  if (size < head.size() || size > kMostInflation * bytes.size()) {
    inflater.fail(fmt::format("the GLB in it tells {} bytes, which {} bytes of gzip cannot hold",
                              size, bytes.size()));
  }
  std::vector<std::byte> plain(size);
  std::copy(head.begin(), head.end(), plain.begin());
  inflater.read(std::span(plain).subspan(head.size()));
  inflater.finish();
  return plain;
}

}  // namespace meshhier::storage
