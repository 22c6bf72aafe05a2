#include "images/image_codec.h"

#include "hierarchy/error.h"
#include "images/formats.h"
#include "images/ktx2_coder.h"
#include "images/source_buffer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::images {
namespace {

constexpr std::size_t kMarkBytes = 12;
constexpr int kBestQuality = 100;

std::string read_mark(const ByteSource& source) {
  std::array<std::byte, kMarkBytes> mark{};
  const std::size_t count = read_at(source, 0, mark);
  return {reinterpret_cast<const char*>(mark.data()), count};
}

std::optional<ImageFormat> format_of(std::string_view mark) {
  if (mark.starts_with("\xff\xd8\xff"))
    return ImageFormat::jpeg;
  if (mark.starts_with("\x89PNG\r\n\x1a\n"))
    return ImageFormat::png;
  if (mark.size() == kMarkBytes && mark.starts_with("RIFF") && mark.ends_with("WEBP"))
    return ImageFormat::webp;
  if (mark == std::string_view("\xabKTX 20\xbb\r\n\x1a\n"))
    return ImageFormat::ktx2;
  return {};
}

ByteSource source_of(std::span<const std::byte> bytes) {
  return [bytes](std::uint64_t offset, std::span<std::byte> into) {
    const std::size_t from = std::min<std::uint64_t>(offset, bytes.size());
    const std::size_t count = std::min(into.size(), bytes.size() - from);
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(from), count, into.begin());
    return count;
  };
}

}  // namespace

std::unique_ptr<ImageReader> open_image(ByteSource source, const std::string& name) {
  const std::optional<ImageFormat> format = format_of(read_mark(source));
  if (!format)
    throw Error(ErrorCode::input, name + " is neither JPEG nor PNG nor WebP");
  switch (*format) {
    case ImageFormat::jpeg:
      return open_jpeg(std::move(source), name);
    case ImageFormat::png:
      return open_png(std::move(source), name);
    case ImageFormat::ktx2:
      return open_ktx2(std::move(source), name);
    case ImageFormat::webp:
      break;
  }
  return open_webp(std::move(source), name);
}

Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                   std::uint64_t most_texels) {
  const std::unique_ptr<ImageReader> reader = open_image(source_of(bytes), name);
  const ImageInfo& info = reader->info();
  if (std::uint64_t{info.width} * info.height > most_texels)
    throw Error(ErrorCode::input, name + ": the picture has " + std::to_string(info.width) + " x " +
                                      std::to_string(info.height) + " texels, more than the " +
                                      std::to_string(most_texels) + " that there may be");
  Image image(info.width, info.height, info.channels);
  reader->read_rows(image.texels.data(), image.height);
  return image;
}

std::vector<std::byte> encode_image(const Image& image, ImageFormat format, int quality) {
  assert(image.width >= 1 && image.width <= kMaxSourceSide);
  assert(image.height >= 1 && image.height <= kMaxSourceSide);
  assert(quality >= 1 && quality <= 100);
  switch (format) {
    case ImageFormat::jpeg:
      return encode_jpeg(image, quality);
    case ImageFormat::png:
      return encode_png(image);
    case ImageFormat::ktx2:
      return encode_ktx2(image, quality == kBestQuality ? Ktx2Content::uastc : Ktx2Content::etc1s,
                         quality);
    case ImageFormat::webp:
      break;
  }
  return encode_webp(image, quality);
}

std::vector<std::byte> encode_normal_map(const Image& image, const NormalMapFormat& format) {
  assert(image.channels == 3);
  switch (format.format) {
    case ImageFormat::jpeg:
      return encode_normal_jpeg(image, format.quality);
    case ImageFormat::ktx2:
      return encode_ktx2(image, Ktx2Content::directions, kBestQuality);
    case ImageFormat::png:
    case ImageFormat::webp:
      break;
  }
  return encode_image(image, format.format, kBestQuality);
}

}  // namespace meshhier::images
