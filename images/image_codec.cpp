#include "images/image_codec.h"

#include "base/error.h"
#include "images/formats.h"
#include "images/source_buffer.h"

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

namespace meshhier::images {
namespace {

/// No format's marks lie farther from the beginning.
constexpr std::size_t kMarkBytes = 16;

std::string read_mark(const ByteSource& source) {
  std::array<std::byte, kMarkBytes> mark{};
  const std::size_t count = read_at(source, 0, mark);
  return {reinterpret_cast<const char*>(mark.data()), count};
}

/// Returns "neither JPEG nor PNG".
std::string none_of_these() {
  std::string text;
  for (const ImageFormatRow& row : kImageFormats)
    text += (text.empty() ? "neither " : " nor ") + std::string(row.file.title);
  return text;
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
  const std::string mark = read_mark(source);
  for (const ImageFormatRow& row : kImageFormats) {
    if (row.file.is_start(mark))
      return coders_of(row.value).open(std::move(source), name);
  }
  throw Error(ErrorCode::input, name + " is " + none_of_these());
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
  assert(quality >= 1 && quality <= kBestQuality);
  return coders_of(format).encode(image, quality);
}

std::vector<std::byte> encode_normal_map(const Image& image, const NormalMapFormat& format) {
  assert(image.channels == 3);
  return coders_of(format.format).encode_directions(image, format.quality);
}

}  // namespace meshhier::images
