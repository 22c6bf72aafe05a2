#include "mesh_io/input_stream.h"

#include "mesh_io/gzip_stream.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace meshhier::mesh_io {
namespace {

class PlainStream final : public InputStream {
 public:
  PlainStream(const InputFile& input, ReadWatch watch) : blocks_(input, std::move(watch)) {}

  std::size_t read(std::span<std::byte> to) override {
    std::size_t filled = 0;
    while (filled < to.size()) {
      if (rest_.empty() && (rest_ = blocks_.next()).empty())
        break;
      const std::size_t count = std::min(rest_.size(), to.size() - filled);
      std::memcpy(to.data() + filled, rest_.data(), count);
      rest_ = rest_.subspan(count);
      filled += count;
    }
    return filled;
  }

 private:
  FileBlocks blocks_;
  std::span<const std::byte> rest_;
};

}  // namespace

FileBlocks::FileBlocks(const InputFile& input, ReadWatch watch)
    : input_(input), watch_(std::move(watch)) {}

std::span<const std::byte> FileBlocks::next() {
  const auto size = static_cast<std::size_t>(
      std::min<std::uint64_t>(storage::FileChecksum::kBlockBytes, input_.bytes - offset_));
  if (size == 0)
    return {};
  if (watch_)
    watch_(size);
  buffer_.resize(size);
  input_.read(offset_, buffer_);
  offset_ += size;
  return buffer_;
}

bool is_gzip(const storage::File& file) {
  std::array<std::byte, 2> start{};
  return file.read_at(0, start) == start.size() && is_gzip_start(start);
}

std::unique_ptr<InputStream> open_stream(const InputFile& input, ReadWatch watch) {
  if (is_gzip(input.file))
    return make_gzip_stream(input, std::move(watch));
  return std::make_unique<PlainStream>(input, std::move(watch));
}

std::uint64_t skip(InputStream& stream, std::uint64_t bytes) {
  std::vector<std::byte> block(std::size_t{1} << 16);
  std::uint64_t skipped = 0;
  for (std::size_t got = block.size(); got == block.size() && skipped < bytes; skipped += got) {
    block.resize(std::min<std::uint64_t>(block.size(), bytes - skipped));
    got = stream.read(block);
  }
  return skipped;
}

}  // namespace meshhier::mesh_io
