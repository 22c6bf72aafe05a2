#include "base/error.h"
#include "images/coders.h"
#include "images/ktx2_coder.h"
#include "images/source_buffer.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::images {
namespace {

// KTX 2.0: bytes of the head, and where in it numbers lie.
constexpr std::size_t kKtx2HeadBytes = 80, kKtx2LevelBytes = 24;
constexpr std::size_t kVkFormatAt = 12, kWidthAt = 20, kHeightAt = 24, kDepthAt = 28,
                      kLayersAt = 32, kFacesAt = 36, kLevelsAt = 40, kDescriptionAt = 48,
                      kDescriptionBytesAt = 52, kGlobalDataAt = 64;
constexpr std::uint32_t kMostLevels = 16;
// Khronos Data Format: where the first block says its model, and its samples their channels.
constexpr std::size_t kModelAt = 12, kSampleAt = 28, kSampleBytes = 16, kChannelAt = 3;
constexpr std::uint32_t kEtc1s = 163, kUastc = 166;
constexpr std::uint32_t kChannelBits = 0x0f, kUastcRgba = 3;
constexpr std::uint32_t kLeastDescription = kSampleAt + kSampleBytes;
constexpr std::uint32_t kMostDescription = 1024;

/// No coder makes more of a picture with all smaller ones.
constexpr std::uint64_t kMostKtx2BytesPerTexel = 4;
constexpr std::uint64_t kMostSlack = std::uint64_t{1} << 20;

class Ktx2Reader final : public ImageReader {
 public:
  Ktx2Reader(ByteSource source, std::string name)
      : source_(std::move(source)), name_(std::move(name)) {
    read_head();
  }
  const ImageInfo& info() const override { return info_; }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override;

 private:
  [[noreturn]] void fail(std::string_view message) const {
    throw Error(ErrorCode::input, name_ + ": " + std::string(message));
  }
  void read_all(std::uint64_t offset, std::span<std::byte> into) const {
    if (read_at(source_, offset, into) < into.size())
      fail(kEndsEarly);
  }
  void read_head();
  std::uint32_t channels_of(std::span<const std::byte> head) const;
  std::uint64_t end_of(std::span<const std::byte> head) const;

  ByteSource source_;
  std::string name_;
  ImageInfo info_;
  std::uint64_t file_bytes_ = 0;
  std::uint32_t next_row_ = 0;  ///< the next row to be handed out
  Image whole_;
};

std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) {
  return storage::load_little<std::uint32_t>(bytes.data() + at);
}

std::uint64_t u64(std::span<const std::byte> bytes, std::size_t at) {
  return storage::load_little<std::uint64_t>(bytes.data() + at);
}

void Ktx2Reader::read_head() {
  std::array<std::byte, kKtx2HeadBytes> head{};
  read_all(0, head);
  const std::uint32_t width = u32(head, kWidthAt), height = u32(head, kHeightAt);
  if (u32(head, kVkFormatAt) != 0 || u32(head, kDepthAt) != 0 || u32(head, kLayersAt) > 1 ||
      u32(head, kFacesAt) != 1 || u32(head, kLevelsAt) == 0 || u32(head, kLevelsAt) > kMostLevels)
    fail("of KTX2, single pictures of Basis Universal (ETC1S, UASTC) are read");
  if (width == 0 || height == 0 || std::max(width, height) > kMaxImageSide)
    fail("the picture is broken: a side has no texels, or more than " +
         std::to_string(kMaxImageSide));
  info_ = {.format = ImageFormat::ktx2,
           .width = width,
           .height = height,
           .channels = channels_of(head),
           .decoder_bytes = 0};
  file_bytes_ = end_of(head);
  const std::uint64_t texels = std::uint64_t{width} * height;
  info_.decoder_bytes = file_bytes_ + 2 * 4 * texels + ktx2_coder_bytes(texels);
}

std::uint32_t Ktx2Reader::channels_of(std::span<const std::byte> head) const {
  const std::uint32_t bytes = u32(head, kDescriptionBytesAt);
  if (bytes < kLeastDescription || bytes > kMostDescription)
    fail("the picture is broken: its description has an impossible size");
  std::vector<std::byte> description(bytes);
  read_all(u32(head, kDescriptionAt), description);
  const auto model = std::to_integer<std::uint32_t>(description[kModelAt]);
  if (model == kEtc1s)
    return bytes >= kLeastDescription + kSampleBytes ? 4 : 3;
  if (model != kUastc)
    fail("of KTX2, pictures of Basis Universal (ETC1S, UASTC) are read");
  const auto channel = std::to_integer<std::uint32_t>(description[kSampleAt + kChannelAt]);
  return (channel & kChannelBits) == kUastcRgba ? 4 : 3;
}

/// Returns the end of all levels, and of the data that they share.
std::uint64_t Ktx2Reader::end_of(std::span<const std::byte> head) const {
  const std::uint64_t most =
      std::uint64_t{info_.width} * info_.height * kMostKtx2BytesPerTexel + kMostSlack;
  std::vector<std::byte> levels(std::size_t{u32(head, kLevelsAt)} * kKtx2LevelBytes);
  read_all(kKtx2HeadBytes, levels);
  std::uint64_t end = kKtx2HeadBytes + levels.size();
  const auto add = [&](std::uint64_t offset, std::uint64_t bytes) {
    if (offset > most || bytes > most - offset)
      fail("the picture is broken: it says that it is larger than any picture of its size");
    end = std::max(end, offset + bytes);
  };
  for (std::size_t at = 0; at < levels.size(); at += kKtx2LevelBytes)
    add(u64(levels, at), u64(levels, at + 8));
  add(u64(head, kGlobalDataAt), u64(head, kGlobalDataAt + 8));
  return end;
}

void Ktx2Reader::read_rows(std::uint8_t* rows, std::uint32_t count) {
  assert(count <= info_.height - next_row_);
  if (whole_.texels.empty()) {
    std::vector<std::byte> file(file_bytes_);
    read_all(0, file);
    Image shape;
    shape.width = info_.width;
    shape.height = info_.height;
    shape.channels = info_.channels;
    whole_ = decode_ktx2(file, shape, name_);
  }
  std::copy_n(whole_.at(0, next_row_), std::size_t{count} * info_.width * info_.channels, rows);
  next_row_ += count;
}

}  // namespace

std::unique_ptr<ImageReader> open_ktx2(ByteSource source, const std::string& name) {
  return std::make_unique<Ktx2Reader>(std::move(source), name);
}

}  // namespace meshhier::images
