#include "mesh_io/gzip_stream.h"

#include "base/error.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

namespace meshhier::mesh_io {
namespace {

/// zlib's largest window, and 16 more: a gzip header and its checksum.
constexpr int kGzipWindow = 15 + 16;

class GzipStream final : public InputStream {
 public:
  GzipStream(const InputFile& input, ReadWatch watch) : blocks_(input, std::move(watch)) {
    if (inflateInit2(&state_, kGzipWindow) != Z_OK)
      throw Error(ErrorCode::internal, "zlib cannot be used");
  }
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;
  ~GzipStream() override { inflateEnd(&state_); }

  std::size_t read(std::span<std::byte> to) override;

 private:
  bool have_input();
  void inflate_some();
  bool to_next_member();
  std::uint64_t offset() const { return blocks_.offset() - state_.avail_in; }
  [[noreturn]] void fail(const std::string& message) const {
    fail_at_byte(blocks_.input().file.path(), offset(), message);
  }

  FileBlocks blocks_;
  z_stream state_{};
  bool in_member_ = true;  ///< the first one is there, or there would be no stream
};

/// Returns false at the end of the file.
bool GzipStream::have_input() {
  if (state_.avail_in > 0)
    return true;
  const std::span<const std::byte> block = blocks_.next();
  // zlib's interface lacks the const.
  state_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(block.data()));
  state_.avail_in = static_cast<uInt>(block.size());
  return !block.empty();
}

void GzipStream::inflate_some() {
  if (!have_input())
    fail("expected more gzip data, found the end of the file (truncated)");
  const int result = inflate(&state_, Z_NO_FLUSH);
  if (result == Z_STREAM_END) {
    in_member_ = false;
  } else if (result != Z_OK && result != Z_BUF_ERROR) {
    fail(fmt::format("expected gzip data, found damaged bytes ({})",
                     state_.msg != nullptr ? state_.msg : "not deflate"));
  }
}

/// Returns false if the file ends here.
bool GzipStream::to_next_member() {
  bool padded = false;
  for (; have_input() && *state_.next_in == 0; ++state_.next_in, --state_.avail_in)
    padded = true;
  if (!have_input())
    return false;
  constexpr Bytef kFirstMagic = 0x1f;
  if (padded || *state_.next_in != kFirstMagic)
    fail("expected the end of the file behind the gzip data, found other bytes");
  inflateReset(&state_);
  in_member_ = true;
  return true;
}

std::size_t GzipStream::read(std::span<std::byte> to) {
  constexpr std::size_t kMost = std::numeric_limits<uInt>::max();
  state_.next_out = reinterpret_cast<Bytef*>(to.data());
  state_.avail_out = static_cast<uInt>(std::min(to.size(), kMost));
  const uInt wanted = state_.avail_out;
  while (state_.avail_out > 0 && (in_member_ || to_next_member()))
    inflate_some();
  return wanted - state_.avail_out;
}

}  // namespace

bool is_gzip_start(std::span<const std::byte> start) {
  return start[0] == std::byte{0x1f} && start[1] == std::byte{0x8b};
}

std::unique_ptr<InputStream> make_gzip_stream(const InputFile& input, ReadWatch watch) {
  return std::make_unique<GzipStream>(input, std::move(watch));
}

}  // namespace meshhier::mesh_io
