#include "images/row_writer.h"

#include "images/formats.h"
#include "images/image_codec.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace meshhier::images {
namespace {

std::uint64_t texels_of(const WrittenImage& image) {
  return std::uint64_t{image.width} * image.height;
}

bool is_held(const WrittenImage& image) {
  const FormatCoders& row = coders_of(image.format);
  return row.open_rows == nullptr || texels_of(image) <= row.most_held_texels;
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
  constexpr std::uint64_t kBuffers = std::uint64_t{1} << 20;
  if (!is_held(image))
    return kBuffers;
  const std::uint64_t texels = texels_of(image);
  return texels * image.channels + coders_of(image.format).encoder_bytes(texels, image.quality);
}

std::unique_ptr<RowWriter> open_row_writer(const WrittenImage& image, ByteSink sink) {
  assert(coders_of(image.format).open_rows != nullptr);
  return coders_of(image.format).open_rows(image, std::move(sink));
}

}  // namespace meshhier::images
