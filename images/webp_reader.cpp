#include "base/error.h"
#include "images/coders.h"
#include "images/source_buffer.h"

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <webp/decode.h>

namespace meshhier::images {
namespace {

constexpr std::size_t kHeadBytes = 64;  ///< more than size and kind take
constexpr std::size_t kRiffBytes = 12;
/// Texels that the library holds besides those that come out: of lossless pictures, and of alpha.
constexpr std::uint64_t kBytesPerTexel = 5;
/// Tables and rows of a lossy picture: up to 16383 columns.
constexpr std::uint64_t kLossyBytes = 2 << 20;
constexpr int kLossy = 1;  ///< WebPBitstreamFeatures::format

std::uint64_t load_u32(std::span<const std::byte> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 4; i-- > 0;)
    value = value << 8 | std::to_integer<std::uint64_t>(bytes[i]);
  return value;
}

/// The library has no rows to give before the picture is whole.
class WebpReader final : public ImageReader {
 public:
  WebpReader(ByteSource source, std::string name)
      : source_(std::move(source)), name_(std::move(name)) {
    read_head();
  }
  const ImageInfo& info() const override { return info_; }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override;

 private:
  [[noreturn]] void fail(std::string_view message) const {
    throw Error(ErrorCode::input, name_ + ": " + std::string(message));
  }
  void check(VP8StatusCode status) const;
  void read_head();
  std::vector<std::byte> read_file() const;
  void decode();
  std::size_t row_bytes() const { return std::size_t{info_.width} * info_.channels; }

  ByteSource source_;
  std::string name_;
  ImageInfo info_;
  std::uint64_t file_bytes_ = 0;
  std::uint32_t next_row_ = 0;  ///< the next row to be handed out
  std::vector<std::uint8_t> whole_;
};

void WebpReader::check(VP8StatusCode status) const {
  switch (status) {
    case VP8_STATUS_OK:
      return;
    case VP8_STATUS_NOT_ENOUGH_DATA:
      fail(kEndsEarly);
    case VP8_STATUS_OUT_OF_MEMORY:
      throw std::bad_alloc();
    default:
      fail("the picture is broken: this is no WebP data that can be decoded");
  }
}

void WebpReader::read_head() {
  std::array<std::byte, kHeadBytes> head{};
  const std::size_t count = read_at(source_, 0, head);
  if (count < kRiffBytes)
    fail(kEndsEarly);
  file_bytes_ = load_u32(std::span(head).subspan(4)) + 8;
  WebPBitstreamFeatures features;
  check(WebPGetFeatures(reinterpret_cast<const std::uint8_t*>(head.data()), count, &features));
  if (features.has_animation != 0)
    fail("the picture is animated; only still ones are read");
  info_ = {.format = ImageFormat::webp,
           .width = static_cast<std::uint32_t>(features.width),
           .height = static_cast<std::uint32_t>(features.height),
           .channels = features.has_alpha != 0 ? 4U : 3U,
           .decoder_bytes = file_bytes_};
  const bool plain = features.format == kLossy && features.has_alpha == 0;
  info_.decoder_bytes +=
      (row_bytes() + (plain ? 0 : kBytesPerTexel * info_.width)) * info_.height + kLossyBytes;
}

std::vector<std::byte> WebpReader::read_file() const {
  std::byte last{};
  if (source_(file_bytes_ - 1, {&last, 1}) == 0)
    fail(kEndsEarly);
  std::vector<std::byte> bytes(file_bytes_);
  if (read_at(source_, 0, bytes) < bytes.size())
    fail(kEndsEarly);
  return bytes;
}

void WebpReader::decode() {
  const std::vector<std::byte> bytes = read_file();
  whole_.resize(row_bytes() * info_.height);
  WebPDecoderConfig config;
  WebPInitDecoderConfig(&config);
  config.output.colorspace = info_.channels == 4 ? MODE_RGBA : MODE_RGB;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {
      .rgba = whole_.data(), .stride = static_cast<int>(row_bytes()), .size = whole_.size()};
  check(WebPDecode(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), &config));
}

void WebpReader::read_rows(std::uint8_t* rows, std::uint32_t count) {
  assert(count <= info_.height - next_row_);
  if (whole_.empty())
    decode();
  std::memcpy(rows, whole_.data() + next_row_ * row_bytes(), count * row_bytes());
  next_row_ += count;
}

}  // namespace

std::unique_ptr<ImageReader> open_webp(ByteSource source, const std::string& name) {
  return std::make_unique<WebpReader>(std::move(source), name);
}

}  // namespace meshhier::images
