#include "images/row_writer.h"

#include "images/formats.h"
#include "images/image_codec.h"
#include "images/ktx2_coder.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace meshhier::images {
namespace {

/// Larger ones have the standard's codes: 6 bytes a texel would wait for the best.
constexpr std::uint64_t kMostHeldTexels = std::uint64_t{1} << 20;

std::uint64_t texels_of(const WrittenImage& image) {
  return std::uint64_t{image.width} * image.height;
}

bool is_held(const WrittenImage& image) {
  return image.format == ImageFormat::webp || image.format == ImageFormat::ktx2 ||
         (image.format == ImageFormat::jpeg && texels_of(image) <= kMostHeldTexels);
}

class HeldWriter final : public RowWriter {
 public:
  HeldWriter(const WrittenImage& image, ByteSink sink)
      : written_(image),
        sink_(std::move(sink)),
        image_(image.width, image.height, image.channels) {}

  void write_row(const std::uint8_t* row) override {
    std::copy_n(row, std::size_t{image_.width} * image_.channels, image_.at(0, rows_++));
  }
  void finish() override { sink_(encode_image(image_, written_.format, written_.quality)); }

 private:
  WrittenImage written_;
  ByteSink sink_;
  Image image_;
  std::uint32_t rows_ = 0;
};

}  // namespace

std::unique_ptr<RowWriter> open_picture_writer(const WrittenImage& image, ByteSink sink) {
  if (is_held(image))
    return std::make_unique<HeldWriter>(image, std::move(sink));
  return open_row_writer(image, std::move(sink));
}

std::uint64_t held_bytes(const WrittenImage& image) {
  constexpr std::uint64_t kJpeg = 6, kWebp = 4, kLosslessWebp = 21, kRgba = 4,
                          kBuffers = std::uint64_t{1} << 20;
  if (!is_held(image))
    return kBuffers;
  if (image.format == ImageFormat::ktx2)
    return texels_of(image) * (image.channels + 2 * kRgba) +
           coder_bytes(image.format, texels_of(image));
  const std::uint64_t encoder = image.format == ImageFormat::jpeg ? kJpeg
                                : image.quality == 100            ? kLosslessWebp
                                                                  : kWebp;
  return texels_of(image) * (image.channels + encoder);
}

std::unique_ptr<RowWriter> open_row_writer(const WrittenImage& image, ByteSink sink) {
  assert(image.format == ImageFormat::png || image.format == ImageFormat::jpeg);
  return image.format == ImageFormat::png
             ? open_png_writer(image, std::move(sink))
             : open_jpeg_writer(image, JpegCodes::standard, std::move(sink));
}

}  // namespace meshhier::images
