#include "base/error.h"
#include "images/coders.h"
#include "images/ktx2_coder.h"
#include "images/ktx2_head.h"
#include "images/source_buffer.h"
#include "images/uastc_block.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <zstd.h>

namespace meshhier::images {
namespace {

/// What readers of both kinds have.
class Ktx2Reader : public ImageReader {
 public:
  Ktx2Reader(ByteSource source, std::string name, Ktx2Head head)
      : head_(std::move(head)), source_(std::move(source)), name_(std::move(name)) {
    info_ = {.format = ImageFormat::ktx2,
             .width = head_.width,
             .height = head_.height,
             .channels = head_.channels,
             .decoder_bytes = 0};
  }
  const ImageInfo& info() const override { return info_; }

 protected:
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(ErrorCode::input, name_ + ": the picture is broken: " + message);
  }
  std::vector<std::byte> read_part(std::uint64_t offset, std::uint64_t count) const {
    std::vector<std::byte> bytes(count);
    if (read_at(source_, offset, bytes) < count)
      throw Error(ErrorCode::input, name_ + ": " + std::string(kEndsEarly));
    return bytes;
  }
  std::uint64_t texels() const { return std::uint64_t{head_.width} * head_.height; }

  Ktx2Head head_;
  ByteSource source_;
  std::string name_;
  ImageInfo info_;
  std::uint32_t next_row_ = 0;  ///< the next row to be handed out
};

/// Another program decodes these as a whole.
class Etc1sReader final : public Ktx2Reader {
 public:
  Etc1sReader(ByteSource source, std::string name, Ktx2Head head)
      : Ktx2Reader(std::move(source), std::move(name), std::move(head)) {
    info_.decoder_bytes = head_.file_bytes + 2 * 4 * texels() + ktx2_coder_bytes(texels());
  }
  std::string missing() const override { return missing_for_ktx2(); }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override {
    assert(count <= info_.height - next_row_);
    if (whole_.texels.empty()) {
      Image shape;
      shape.width = info_.width;
      shape.height = info_.height;
      shape.channels = info_.channels;
      whole_ = decode_ktx2(read_part(0, head_.file_bytes), shape, name_);
    }
    std::copy_n(whole_.at(0, next_row_), std::size_t{count} * info_.width * info_.channels, rows);
    next_row_ += count;
  }

 private:
  Image whole_;
};

/// Holds the blocks of the largest level, and the texels of one row of them.
class UastcReader final : public Ktx2Reader {
 public:
  UastcReader(ByteSource source, std::string name, Ktx2Head head)
      : Ktx2Reader(std::move(source), std::move(name), std::move(head)) {
    constexpr std::uint64_t kUnpacking = std::uint64_t{1} << 18;
    for (std::size_t i = 0; i < head_.levels.size(); ++i) {
      if (head_.levels[i].unpacked != block_bytes(i))
        fail("its blocks are not those of its size");
    }
    info_.decoder_bytes = head_.levels[0].bytes + block_bytes(0) + kUnpacking +
                          kBlockSide * std::uint64_t{head_.width} * head_.channels;
  }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override {
    assert(count <= info_.height - next_row_);
    if (blocks_.empty())
      read_blocks();
    const std::size_t row = std::size_t{info_.width} * info_.channels;
    for (std::uint32_t i = 0; i < count; ++i, ++next_row_) {
      if (next_row_ % kBlockSide == 0)
        decode_strip(next_row_ / kBlockSide);
      std::copy_n(strip_.begin() + static_cast<std::ptrdiff_t>(next_row_ % kBlockSide * row), row,
                  rows + i * row);
    }
  }

 private:
  std::uint32_t columns() const { return (head_.width + kBlockSide - 1) / kBlockSide; }
  std::uint64_t block_bytes(std::size_t level) const {
    const auto blocks = [level](std::uint32_t side) {
      return (std::max(side >> level, 1U) + kBlockSide - 1) / kBlockSide;
    };
    return std::uint64_t{blocks(head_.width)} * blocks(head_.height) * kUastcBlockBytes;
  }
  void read_blocks();
  void decode_strip(std::uint32_t row);
  void put_texels(std::uint32_t column, const std::array<Rgba, kBlockTexels>& texels);

  std::vector<std::byte> blocks_;
  std::vector<std::uint8_t> strip_;
};

void UastcReader::read_blocks() {
  std::vector<std::byte> level = read_part(head_.levels[0].offset, head_.levels[0].bytes);
  const std::uint64_t wanted = block_bytes(0);
  if (head_.scheme == ktx2::kPlain) {
    if (level.size() != wanted)
      fail("its blocks are not those of its size");
    blocks_ = std::move(level);
    return;
  }
  const unsigned long long said = ZSTD_getFrameContentSize(level.data(), level.size());
  if (said == ZSTD_CONTENTSIZE_ERROR || (said != ZSTD_CONTENTSIZE_UNKNOWN && said != wanted))
    fail("its level is no Zstandard data of its size");
  std::vector<std::byte> blocks(wanted);
  if (ZSTD_decompress(blocks.data(), blocks.size(), level.data(), level.size()) != wanted)
    fail("its level is no Zstandard data that can be unpacked");
  blocks_ = std::move(blocks);
}

void UastcReader::decode_strip(std::uint32_t row) {
  strip_.resize(kBlockSide * std::size_t{info_.width} * info_.channels);
  for (std::uint32_t column = 0; column < columns(); ++column) {
    const std::size_t number = std::size_t{row} * columns() + column;
    const auto block = unpack_block(std::span<const std::byte, kUastcBlockBytes>(
        blocks_.data() + number * kUastcBlockBytes, kUastcBlockBytes));
    if (!block)
      fail("a block has a mode or a pattern that there is not");
    put_texels(column, texels_of(*block));
  }
}

void UastcReader::put_texels(std::uint32_t column, const std::array<Rgba, kBlockTexels>& texels) {
  const std::uint32_t left = column * kBlockSide;
  const std::uint32_t width = std::min(kBlockSide, info_.width - left);
  for (std::uint32_t y = 0; y < kBlockSide; ++y) {
    std::uint8_t* const to = strip_.data() + (std::size_t{y} * info_.width + left) * info_.channels;
    for (std::uint32_t x = 0; x < width; ++x)
      images::copy_texel(texels[y * kBlockSide + x].data(), to + std::size_t{x} * info_.channels,
                         info_.channels);
  }
}

}  // namespace

std::unique_ptr<ImageReader> open_ktx2(ByteSource source, const std::string& name) {
  Ktx2Head head = read_ktx2_head(source, name);
  if (head.model == ktx2::kEtc1s)
    return std::make_unique<Etc1sReader>(std::move(source), name, std::move(head));
  return std::make_unique<UastcReader>(std::move(source), name, std::move(head));
}

}  // namespace meshhier::images
